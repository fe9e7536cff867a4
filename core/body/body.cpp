// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/body/body.h"

#include <cstdio>

#include "core/bones/guess_bone_labels.h"
#include "core/bones/input_doubts.h"
#include "core/prepare/guess_skin.h"
#include "core/volume_io/grey_image.h"

namespace limber {

namespace {

void guess_bones(Body& body, const std::string& volume) {
  const auto guess = guess_bone_tissue(body.file.volume, body.tissues, body.rig);
  if (!guess) return;
  const double value = body.tissues.find(guess->label)->file_value;
  body.tissues = with_bones(std::move(body.tissues), {value});
  char text[200];
  std::snprintf(text, sizeof text,
                ": label %.0f is used as bone, because it lies along %.0f %% of the rig's long bones; name other "
                "labels with --bones or --tissues",
                value, 100 * guess->share_of_rig);
  body.warnings.push_back("no tissue table says which labels are bone: " + volume + text);
}

void take_skin(Body& body, const std::string& volume) {
  const auto guess = guess_skin(body.file.volume, body.tissues);
  if (!guess) return;
  const double value = body.tissues.find(guess->label)->file_value;
  body.tissues = with_skin(std::move(body.tissues), guess->label);
  char text[200];
  std::snprintf(text, sizeof text,
                ": label %.0f is used as skin, because it is a thin sheet over %.0f %% of the surface; name another "
                "label with --tissues",
                value, 100 * guess->share_of_surface);
  body.warnings.push_back("no tissue table says which label is skin: " + volume + text);
}

}  // namespace

Body make_body(VolumeFile file, const TissueTable* table, Armature rig, const std::vector<double>& bones, BoneMap map,
               const std::string& where) {
  Body body;
  body.file = std::move(file);
  body.tissues = merge_tissue_tables(body.file.tissues, table);
  require_labels(body.file.volume, body.tissues, where);
  body.rig = std::move(rig);
  body.bone_map = std::move(map);
  if (!bones.empty()) body.tissues = with_bones(std::move(body.tissues), bones);
  else guess_bones(body, where);
  take_skin(body, where);
  body.doubts = input_doubts(body.file.volume, body.tissues, body.rig);
  body.warnings.insert(body.warnings.end(), body.doubts.begin(), body.doubts.end());
  return body;
}

}  // namespace limber
