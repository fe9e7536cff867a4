// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/body_options.h"

#include <cstdio>

#include "core/bones/guess_bone_labels.h"
#include "core/bones/input_doubts.h"
#include "core/cmd/command.h"
#include "core/prepare/guess_skin.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/grey_image.h"

namespace limber::cmd {

void add_body_options(CLI::App& command, BodyOptions& options) {
  command.add_option("VOLUME", options.volume, "label volume")->required();
  command.add_option("--rig", options.rig, "rig (JSON, Bender .vtk or .arm, BVH)")->required();
  command.add_option("--tissues", options.tissues, "tissue table (JSON, .ctbl, ITK-SNAP)");
  command.add_option("--bones", options.bones, "labels that are bone, as numbered in the file")
      ->delimiter(',')
      ->type_name("L,L");
  command
      .add_option("--bone-map", options.bone_map,
                  "JSON that says which rig bone a label follows: {\"label or label@left\": \"rig bone\"}")
      ->type_name("FILE");
}

namespace {

void guess_bones(Body& body, const std::string& volume) {
  const auto guess = guess_bone_tissue(body.file.volume, body.tissues, body.rig);
  if (!guess) return;
  const double value = body.tissues.find(guess->label)->file_value;
  body.tissues = with_bones(std::move(body.tissues), {value});
  char text[200];
  std::snprintf(
      text, sizeof text,
      ": label %.0f, which lies along %.0f %% of the long bones, is taken for it; say others with --bones or --tissues",
      value, 100 * guess->share_of_rig);
  warn("no table says what is bone: " + volume + text);
}

void take_skin(Body& body, const std::string& volume) {
  const auto guess = guess_skin(body.file.volume, body.tissues);
  if (!guess) return;
  const double value = body.tissues.find(guess->label)->file_value;
  body.tissues = with_skin(std::move(body.tissues), guess->label);
  char text[200];
  std::snprintf(text, sizeof text,
                ": label %.0f, a thin sheet over %.0f %% of the surface, is taken for it; say another with --tissues",
                value, 100 * guess->share_of_surface);
  warn("no table says what is skin: " + volume + text);
}

}  // namespace

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
  require_labels(body.file.volume, body.tissues, options.volume);
  ArmatureFile rig = read_armature_file(options.rig);
  warn(rig.warnings);
  body.rig = std::move(rig.armature);
  if (!options.bones.empty()) body.tissues = with_bones(std::move(body.tissues), options.bones);
  else guess_bones(body, options.volume);
  take_skin(body, options.volume);
  if (!options.bone_map.empty()) body.bone_map = read_bone_map(options.bone_map);
  body.doubts = input_doubts(body.file.volume, body.tissues, body.rig);
  warn(body.doubts);
  return body;
}

}  // namespace limber::cmd
