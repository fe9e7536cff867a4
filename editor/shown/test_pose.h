// SPDX-License-Identifier: AGPL-3.0-or-later
// The pose that the body has while its weights are painted: at rest, or in the document's pose, and on top of it one
// joint bent on trial. Neither is an edit: the document's pose stays as it is.
#pragma once

#include <string>

#include "editor/context/editor.h"

namespace limber::editor {

// How the Skin workspace poses the body.
struct TestPose {
  static constexpr double kMost = 150, kStep = 5;  // degrees

  bool posed = false;  // the document's pose; else rest
  std::string bone;    // bent at its head; "" or no bone of the rig: none
  double degrees = 0;
  struct {
    bool posed = false;
    double degrees = 0;
  } before;  // what the body at rest goes back to
};

// Whether the views show the body in a pose: shown_pose().
bool shows_pose(const Editor& editor);
// Of the Skin workspace. Needs a rig.
Pose test_pose(const Editor& editor);

// The bone that the Skin workspace is about: the active one, else the rig's first; none without a rig.
std::optional<int> skin_bone(const Editor& editor);

// Why the active bone cannot be bent on trial; "" when it can.
std::string why_not_bend(const Editor& editor);
// Of the active bone; another that was bent goes back.
double bend(const Editor& editor);
void set_bend(Editor& editor, double degrees);
void clear_bend(Editor& editor);
// To rest, and back to what was shown before: the document's pose, the joint bent on trial, or both. The document's
// pose where neither was.
void toggle_test_pose(Editor& editor);

}  // namespace limber::editor
