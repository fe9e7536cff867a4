// SPDX-License-Identifier: AGPL-3.0-or-later
// The way from a volume to a posed one: five steps, what each has, and what is missing next.
#pragma once

#include <string>
#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

enum class StepState { Done, Next, Later, Working, Warning };

struct Step {
  std::string title;
  StepState state = StepState::Later;
  std::string line;               // what there is, or what is missing
  std::string operator_id;        // its one button
  std::string button;             // the button's word
  std::vector<std::string> more;  // operators that the advanced list offers besides
};
// Always five: Prepare, Rig, Skin, Pose, Resample. At most one is Next: the first that is missing.
std::vector<Step> steps(const Editor& editor);

}  // namespace limber::editor
