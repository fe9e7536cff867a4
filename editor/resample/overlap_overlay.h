// SPDX-License-Identifier: AGPL-3.0-or-later
// Where a result's map claimed a posed voxel twice (core/resample): marked in 3D and in slices over dulled tissue,
// through the same field that differences and measures of finite elements are shown by.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

// A result with its marks.
struct MarkedOverlap {
  std::shared_ptr<const Overlap> overlap;
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueTable> tissues;  // whose colours are dulled
  std::shared_ptr<const TissueVoxels> tissue;
  std::shared_ptr<const std::vector<glm::u8vec3>> field;  // #tissue voxels
};

struct OverlapView {
  bool shown = false;
  std::vector<std::shared_ptr<const MarkedOverlap>> made;  // the last ones, newest last
  std::optional<int> task;
};

// sRGB: of two places of tissue, and of two bones.
glm::vec3 mark_of_overlap(bool of_bones);

// Why there is none to look at; "" when there is.
std::string why_no_overlap(const Editor& editor);
bool shows_overlap(const Editor& editor);
// In place of what else voxels are coloured by.
void show_overlap_overlay(Editor& editor, bool on);
// Into the scenes of this frame.
void show_overlap(Editor& editor);

}  // namespace limber::editor
