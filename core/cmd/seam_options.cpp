// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/seam_options.h"

#include <memory>

#include "core/seams/find_seams.h"
#include "core/seams/seams_io.h"

namespace limber::cmd {

void add_seam_option(CLI::App& command, std::string& seams) {
  command
      .add_option("--seams", seams,
                  "where tissue touches without being one, as 'limber prepare --seams' writes it, or none (default: "
                  "those that given weights were made with, else found by itself)")
      ->type_name("FILE|none");
}

void set_seams(TissueVoxels& tissue, const std::string& seams, const Body& body,
               const std::function<const BoneParts&()>& parts, Progress& progress) {
  const LabelVolume& volume = body.file.volume;
  if (seams == "none") return;
  tissue.set_seams(std::make_shared<const Seams>(
      seams.empty() ? find_seams(volume, tissue, body.tissues, body.rig, parts(), progress)
                    : read_seams(seams, volume, progress)));
}

}  // namespace limber::cmd
