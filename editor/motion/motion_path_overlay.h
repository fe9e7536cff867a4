// SPDX-License-Identifier: AGPL-3.0-or-later
// Motion paths: draws the line along which the tip of each selected bone moves through the playing range, over the 3D
// view. Frames before and after the shown frame have different colours. Dots mark the frames where there is room for
// them, diamonds the keys. Where many bones are selected, only the active one has a path. Points are computed a few at
// a time, so that a long clip does not stop the editor.
#pragma once

#include <memory>
#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

struct MotionPaths {
  // What the points were computed from. When one of these changes, they are computed again.
  std::shared_ptr<const Clip> clip;
  std::shared_ptr<const Armature> armature;
  std::vector<int> bones;
  int first = 0, last = -1;

  std::vector<std::vector<glm::dvec3>> tips;  // by frame from `first` on: the tip of each bone; world, mm
};

// Computes points of the selected bones for at most some milliseconds. Returns null if the paths are switched off, or
// if no bone is selected or no clip moves the rig.
const MotionPaths* motion_paths(Editor& editor);
void draw_motion_paths(Editor& editor);

}  // namespace limber::editor
