// SPDX-License-Identifier: AGPL-3.0-or-later
// The test pose, in which the Skin workspace shows the body while the user paints weights. It is the rest pose or the
// document's pose, with one joint bent in addition to test the weights. The test pose is not part of the document, so a
// change of the test pose cannot be undone.
#pragma once

#include <string>

#include "core/rig/pose.h"

namespace limber::editor {

struct Context;

// The settings of the test pose, in which the Skin workspace shows the body.
struct TestPose {
  // Largest angle of the test pose; step by which keys and the wheel change it; degrees.
  static constexpr double kMost = 150, kStep = 5;

  bool posed = false;  // true: the joint is bent in the document's pose; false: in the rest pose
  std::string bone;    // the bone that is bent at its head; "" or a name not in the rig: none
  double degrees = 0;
  struct {
    bool posed = false;
    double degrees = 0;
  } before;  // the test pose that toggle_test_pose() restores when the body is at rest
};

// Returns true if the views show the body in a pose, which shown_pose() returns, and false if they show it at rest.
bool shows_pose(const Context& context);
// Returns the pose in which the Skin workspace shows the body. Needs a rig.
Pose test_pose(const Context& context);

// Returns the bone whose weights the Skin workspace shows. This is the active bone, or the rig's first bone if no bone
// is active. Returns nothing without a rig.
std::optional<int> skin_bone(const Context& context);

// Returns why the active bone cannot be bent to test its weights; "" when it can.
std::string why_not_bend(const Context& context);
// Return and set the angle by which the test pose bends the active bone, degrees. set_bend() straightens any other bone
// that the test pose has bent so far.
double bend(const Context& context);
void set_bend(Context& context, double degrees);
void clear_bend(Context& context);
// Shows the body at rest if it is shown posed. Otherwise shows the last test pose again, or the document's pose if
// there was no test pose before.
void toggle_test_pose(Context& context);

}  // namespace limber::editor
