// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/seam_options.h"

#include <memory>

#include "core/seams/seams_io.h"

namespace limber::cmd {

void add_seam_option(CLI::App& command, std::string& seams) {
  command
      .add_option("--seams", seams,
                  "file of seams, where tissue touches without being connected, from 'limber prepare --seams'; or none "
                  "(default: the seams that the given weights were made with, else found automatically)")
      ->type_name("FILE|none");
}

SeamChoice read_seam_choice(const std::string& seams, const LabelVolume& volume, Progress& progress) {
  if (seams.empty()) return std::nullopt;
  if (seams == "none") return std::shared_ptr<const Seams>();
  return std::make_shared<const Seams>(read_seams(seams, volume, progress));
}

}  // namespace limber::cmd
