// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/body_options.h"

#include "core/cmd/command.h"
#include "core/rig/armature_io.h"

namespace limber::cmd {

void add_body_options(CLI::App& command, BodyOptions& options) {
  command.add_option("VOLUME", options.volume, "label volume")->required();
  command.add_option("--rig", options.rig, "rig (JSON, Bender .vtk or .arm, BVH)")->required();
  command.add_option("--tissues", options.tissues, "tissue table (JSON, .ctbl, ITK-SNAP)");
  command.add_option("--bones", options.bones, "labels that are bone, as in the file")->delimiter(',')->type_name("L,L");
}

Body read_body(const BodyOptions& options, Progress& progress) {
  Body body;
  body.file = read_volume(options.volume, progress);
  warn(body.file.warnings);
  if (options.tissues.empty()) {
    body.tissues = merge_tissue_tables(body.file.tissues, nullptr);
  } else {
    const TissueTable user = read_tissue_table(options.tissues);
    body.tissues = merge_tissue_tables(body.file.tissues, &user);
  }
  if (!options.bones.empty()) body.tissues = with_bones(std::move(body.tissues), options.bones);
  ArmatureFile rig = read_armature_file(options.rig);
  warn(rig.warnings);
  body.rig = std::move(rig.armature);
  return body;
}

}  // namespace limber::cmd
