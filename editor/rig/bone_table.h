// SPDX-License-Identifier: AGPL-3.0-or-later
// The bone table: for each label of bone tissue, the rig bone that it follows and how that bone was found. The Rig
// workspace lists the labels and can colour them by rig bone. Bones that the user sets are stored in the document's
// bone map, which the computation of weights and the live preview of the posed body use.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/bones/bone_map.h"
#include "editor/volume/body_seams.h"

namespace limber::editor {

struct Context;

struct BoneTable {
  bool coloured = false;  // true: the Rig workspace colours bone tissue by the rig bone that it follows

  // The table that was computed last, with the volume, tissues and rig for which it was computed.
  struct Known {
    SeamSource source;
    std::vector<MappedLabel> rows;
    std::vector<std::string> left_out;  // keys of the bone map's entries whose tissue or bone does not exist
    std::shared_ptr<const TissueVoxels> tissue;
    std::shared_ptr<const std::vector<glm::u8vec3>> field;  // colour of each tissue voxel, sRGB
  };
  std::optional<Known> known;
  std::optional<int> task;  // id of the background task that computes `known`
};

// Returns the bone table; null without a rig or without a volume that has bone tissue. When the volume, the tissues,
// the rig or the bone map have changed, starts a task that computes the table again. Until that task ends, returns the
// earlier table if only the bone map has changed, else null.
const BoneTable::Known* bone_table(Context& context);
// Returns why no bone table can be computed, such as "Import a rig first"; "" when it can.
std::string why_no_bone_table(const Document& document);

// Sets the rig bone that a label of bone tissue follows, and commits this change of the bone map as one edit.
//   side  sets the bone only for the label's voxels on this side of the body; nothing: for all voxels of the label
//   bone  index into the rig's bones; nothing: the bone is found automatically
void map_label(Context& context, Label label, std::optional<BodySide> side, std::optional<int> bone);
void clear_bone_map(Context& context);

// In the picture that is being drawn, gives bone tissue the colour of the rig bone to which the table maps its label,
// if the user has switched this on.
void show_bone_table(Context& context);

}  // namespace limber::editor
