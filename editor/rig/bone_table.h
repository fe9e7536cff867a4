// SPDX-License-Identifier: AGPL-3.0-or-later
// Which rig bone each label of bone tissue follows, and how that was found: listed in the Rig workspace, changed label
// by label, and seen as colours on the bones. What the user says is the document's bone map, which weights and previews
// go by.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/bones/bone_map.h"
#include "editor/context/editor.h"
#include "editor/volume/body_seams.h"

namespace limber::editor {

struct BoneTable {
  bool coloured = false;  // bones in the views of the Rig workspace, by the rig bones that they follow

  // What was found last, and of what body.
  struct Known {
    SeamSource source;
    std::vector<MappedLabel> rows;
    std::vector<std::string> left_out;  // keys of the document's map that name what is not there
    std::shared_ptr<const TissueVoxels> tissue;
    std::shared_ptr<const std::vector<glm::u8vec3>> field;  // #tissue voxels, sRGB
  };
  std::optional<Known> known;
  std::optional<int> task;  // that finds it anew
};

// Null where there is no volume with bone tissue, or no rig. The one of an earlier body, or of an earlier map, while
// the new one is being found, which this begins; null as well where there is no earlier one.
const BoneTable::Known* bone_table(Editor& editor);
std::string why_no_bone_table(const Editor& editor);  // "" where there is one, or will be

// What tissue follows from now on: a bone of the rig, or what is found for it. One edit.
void map_label(Editor& editor, Label label, std::optional<BodySide> side, std::optional<int> bone);
void clear_bone_map(Editor& editor);

// Into the scene of this frame.
void show_bone_table(Editor& editor);

}  // namespace limber::editor
