// SPDX-License-Identifier: AGPL-3.0-or-later
// Motion paths: draws over the 3D view the line along which the tip of each selected bone moves through the playing
// range. Frames before and after the shown frame have different colours. Dots mark the frames if there is room for
// them, and diamonds mark the keys. If many bones are selected, only the active bone has a path. The points are
// computed over several drawn frames, so that a long clip does not block the editor.
#pragma once

#include <memory>
#include <vector>

#include "core/motion/clip.h"

namespace limber::editor {

struct Context;

struct MotionPaths {
  // The inputs from which the points were computed. When one of them changes, the points are computed again.
  std::shared_ptr<const Clip> clip;
  std::shared_ptr<const Armature> armature;
  std::vector<int> bones;
  int first = 0, last = -1;

  // Positions of the bones' tips, world, mm: one list for each frame from `first`, with one position for each of
  // `bones`.
  std::vector<std::vector<glm::dvec3>> tips;
};

// Computes more points of the selected bones' paths, for a few milliseconds at most. Returns null if the paths are
// switched off, no bone is selected, or no clip moves the rig.
const MotionPaths* motion_paths(Context& context);
void draw_motion_paths(Context& context);

}  // namespace limber::editor
