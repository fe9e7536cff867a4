// SPDX-License-Identifier: AGPL-3.0-or-later
// The test pose of the Skin workspace, in which the body is shown while its weights are painted. It is the rest pose or
// the document's pose, with one joint bent in addition to test the weights. The test pose is not part of the document,
// so changing it is no edit.
#pragma once

#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

// The settings of the test pose, in which the Skin workspace shows the body.
struct TestPose {
  static constexpr double kMost = 150, kStep = 5;  // largest angle and step of the test bend, degrees

  bool posed = false;  // true: bends from the document's pose; false: from the rest pose
  std::string bone;    // the bone that is bent at its head; "" or a name not in the rig: none
  double degrees = 0;
  struct {
    bool posed = false;
    double degrees = 0;
  } before;  // the test pose that toggle_test_pose() restores when the body is at rest
};

// Returns whether the views show the body posed, in the pose shown_pose(), and not at rest.
bool shows_pose(const Editor& editor);
// Returns the pose in which the Skin workspace shows the body. Needs a rig.
Pose test_pose(const Editor& editor);

// Returns the bone whose weights the Skin workspace shows: the active bone, else the rig's first bone. Nothing without
// a rig.
std::optional<int> skin_bone(const Editor& editor);

// Returns why the active bone cannot be bent to test its weights; "" when it can.
std::string why_not_bend(const Editor& editor);
// Return and set the test angle by which the active bone is bent, degrees. Setting it straightens a bone that was bent
// before.
double bend(const Editor& editor);
void set_bend(Editor& editor, double degrees);
void clear_bend(Editor& editor);
// Switches from a test pose to the rest pose, and back to the test pose that was shown before. If none was shown
// before, switches to the document's pose.
void toggle_test_pose(Editor& editor);

}  // namespace limber::editor
