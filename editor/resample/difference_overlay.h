// SPDX-License-Identifier: AGPL-3.0-or-later
// Marks in the 3D view and in slices where the compared volumes A and B differ. A voxel of A is marked in a colour of A
// if B has another tissue, or no tissue, at its position. A voxel of B is marked in a colour of B if A has another
// tissue, or none, at its position. All other voxels are dimmed. The renderer gets one colour per voxel. A task
// computes the colours once for a pair of volumes.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/report/volume_difference.h"
#include "core/tissue/tissue_table.h"

namespace limber::editor {

struct Context;

// One of the two compared volumes, with its differing voxels and the colours of all its tissue voxels.
struct ComparedSide {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueVoxels> tissue;
  DifferingSide differing;
  std::shared_ptr<const std::vector<glm::u8vec3>> field;  // for each tissue voxel, its colour, sRGB
};
struct ComparedVolumes {
  ComparedSide a, b;
  std::shared_ptr<const TissueTable> tissues;  // tissue colours, drawn dimmed at voxels that do not differ

  const ComparedSide& side(bool of_a) const { return of_a ? a : b; }
};

struct DifferenceView {
  bool shown = false;
  std::shared_ptr<const ComparedVolumes> made;  // the comparison computed last
  std::optional<int> task;
};

// Colours of the marked voxels of volume A or B, sRGB. `air` is for voxels where the other volume has no tissue,
// `tissue` for voxels where the other volume has another tissue.
struct MarkColours {
  glm::vec3 air, tissue;
};
MarkColours marks_of(bool side_a);

// Returns whether the difference is shown. It is shown in the Resample workspace while there are two volumes to
// compare.
bool shows_difference(const Context& context);
// Turns the overlay on or off. Turning it on turns off the other overlays that colour voxels.
void show_difference_overlay(Context& context, bool on);
// Puts the colours of the differing voxels into the scenes of this frame.
void show_difference(Context& context);
// Returns the comparison of the current volumes A and B; null: not computed yet.
const ComparedVolumes* compared_volumes(const Context& context);
// Returns the tissue that the other volume has at the voxel under the pointer, such as "in B: Fat"; "" if the
// difference is not shown.
std::string other_side_text_at(const Context& context, const glm::ivec3& voxel);

}  // namespace limber::editor
