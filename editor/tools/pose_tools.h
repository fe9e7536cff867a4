// SPDX-License-Identifier: AGPL-3.0-or-later
// Turning bones and dragging joints, as in Blender. The pointer turns about the line of sight; X, Y or Z locks an axis of
// the world, the same key again the bone's own, once more frees it; R turns like a trackball. Digits are degrees or mm.
// Ctrl snaps, Shift goes slowly. A click or Enter keeps the pose, Escape or the right button brings the old one back.
#pragma once

#include <memory>
#include <optional>

#include "editor/modal.h"

namespace limber::editor {

// What a tool is held to.
struct AxisLock {
  int axis = -1;       // 0 .. 2; -1: none
  bool local = false;  // the bone's own instead of the world's
};

//   held  the button whose release ends the tool, where one began it
std::unique_ptr<Modal> begin_turning(Editor& editor, const AxisLock& lock = {}, bool trackball = false, std::optional<MouseButton> held = {});
// The tail of the active bone goes with the pointer and its limb follows; a root's head takes the whole body along.
std::unique_ptr<Modal> begin_dragging(Editor& editor, std::optional<MouseButton> held = {});

}  // namespace limber::editor
