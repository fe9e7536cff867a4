// SPDX-License-Identifier: AGPL-3.0-or-later
// limber info FILE [--json]
#include <memory>

#include "core/cmd/command.h"
#include "core/volume/volume_io.h"

namespace limber::cmd {

void add_info(CLI::App& app) {
  auto* command = app.add_subcommand("info", "what a file is: header, labels, bones, joints");
  auto file = std::make_shared<std::string>();
  command->add_option("FILE", *file, "a volume, rig, motion, weights or mesh")->required();
  command->callback([file] { sha256_of_file(*file); });
}

}  // namespace limber::cmd
