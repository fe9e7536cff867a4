// SPDX-License-Identifier: AGPL-3.0-or-later
// Where sides A and B differ, marked in 3D and in slices: on each side the voxels whose tissue is another one on the
// other side, or none at all, have a colour of that side, and the rest is dull. Through the same field that weights and
// measures of finite elements are shown by; found beside the editor, once for a pair of volumes.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/report/volume_difference.h"
#include "editor/context/editor.h"

namespace limber::editor {

// One of two volumes as held against the other, and what is shown of it.
struct ComparedSide {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueVoxels> tissue;
  DifferingSide differing;
  std::shared_ptr<const std::vector<glm::u8vec3>> field;  // #tissue voxels
};
struct ComparedVolumes {
  ComparedSide a, b;
  std::shared_ptr<const TissueTable> tissues;  // whose colours are dulled

  const ComparedSide& side(bool of_a) const { return of_a ? a : b; }
};

struct DifferenceView {
  bool shown = false;
  std::shared_ptr<const ComparedVolumes> made;  // the last
  std::optional<int> task;
};

// Colours of a side's marks, sRGB: where the other side has nothing, and where it has another tissue.
struct MarkColours {
  glm::vec3 air, tissue;
};
MarkColours marks_of(bool side_a);

// Shown in the Resample workspace, while there are two volumes to compare.
bool shows_difference(const Editor& editor);
// In place of what else voxels are coloured by.
void show_difference_overlay(Editor& editor, bool on);
// Into the scenes of this frame.
void show_difference(Editor& editor);
// What is found of the volumes that are compared; null: not yet.
const ComparedVolumes* compared_volumes(const Editor& editor);
// Of a voxel of what the pointer is on: "at rest: Fat"; "" where the difference is not shown.
std::string other_side_text_at(const Editor& editor, const glm::ivec3& voxel);

}  // namespace limber::editor
