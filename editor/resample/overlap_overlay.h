// SPDX-License-Identifier: AGPL-3.0-or-later
// Marks the posed voxels to which two different points of the body at rest move (core/resample). These voxels are
// coloured in the 3D view and in slices, and all other tissue is dimmed. The renderer gets one colour per voxel.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/project/document.h"

namespace limber::editor {

struct Context;

// A result's overlapping voxels, and a colour for each tissue voxel of the result, which shows where tissue overlaps.
struct MarkedOverlap {
  std::shared_ptr<const Overlap> overlap;
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueTable> tissues;  // tissue colours, drawn dimmed at voxels without overlap
  std::shared_ptr<const TissueVoxels> tissue;
  std::shared_ptr<const std::vector<glm::u8vec3>> field;  // for each tissue voxel, its colour, sRGB
};

struct OverlapView {
  bool shown = false;
  std::vector<std::shared_ptr<const MarkedOverlap>> made;  // cache of results with their colours, newest last
  std::optional<int> task;
};

// Returns the colour that marks overlap, sRGB. If `of_bones` is true, this is the colour of voxels where two bones
// overlap, otherwise the colour of voxels where other tissue overlaps.
glm::vec3 mark_of_overlap(bool of_bones);

// Returns why there is no overlap to show, such as "Resample a pose first"; "" when there is an overlap.
std::string why_no_overlap(const Context& context);
bool shows_overlap(const Context& context);
// Turns the overlay on or off. Turning it on turns off the other overlays that colour voxels.
void show_overlap_overlay(Context& context, bool on);
// Puts the colours of the overlapping voxels into the scenes of this frame.
void show_overlap(Context& context);

}  // namespace limber::editor
