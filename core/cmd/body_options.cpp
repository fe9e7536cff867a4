// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/body_options.h"

#include <optional>

#include "core/cmd/command.h"
#include "core/rig_io/rig_io.h"

namespace limber::cmd {

void add_body_options(CLI::App& command, BodyOptions& options) {
  command.add_option("VOLUME", options.volume, "label volume")->required();
  command.add_option("--rig", options.rig, "rig (JSON, Bender .vtk or .arm, BVH)")->required();
  command.add_option("--tissues", options.tissues, "tissue table (JSON, .ctbl, ITK-SNAP)");
  command
      .add_option("--bones", options.bones,
                  "labels that are bone, as numbers in the volume file (default: from the tissue table, or found "
                  "automatically)")
      ->delimiter(',')
      ->type_name("L,L");
  command
      .add_option("--bone-map", options.bone_map,
                  "JSON file that says which rig bone each bone label follows: {\"label or label@left\": \"rig bone\"}")
      ->type_name("FILE");
}

Body read_body(const BodyOptions& options, Progress& progress) {
  VolumeFile file = read_volume(options.volume, progress);
  warn(file.warnings);
  std::optional<TissueTable> table;
  if (!options.tissues.empty()) table = read_tissue_table(options.tissues);
  ArmatureFile rig = read_armature_file(options.rig);
  warn(rig.warnings);
  BoneMap map;
  if (!options.bone_map.empty()) map = read_bone_map(options.bone_map);
  Body body = make_body(std::move(file), table ? &*table : nullptr, std::move(rig.armature), options.bones,
                        std::move(map), options.volume);
  warn(body.warnings);
  return body;
}

}  // namespace limber::cmd
