// SPDX-License-Identifier: AGPL-3.0-or-later
// The five workflow steps from a volume to a posed volume, with the state of each step. The state tells what to do
// next.
#pragma once

#include <string>
#include <vector>

namespace limber::editor {

struct Context;

enum class StepState { Done, Next, Later, Working, Warning };

struct Step {
  std::string title;
  StepState state = StepState::Later;
  std::string line;               // text that tells what the step has produced, or what is missing for it
  std::string operator_id;        // operator of the step's main button
  std::string button;             // label of the main button
  std::vector<std::string> more;  // operators that are shown while "Advanced steps" is on
};
// Returns the five steps Prepare, Rig, Skin, Pose and Resample. At most one step has the state Next, which marks the
// first step that is not done.
std::vector<Step> steps(const Context& context);

}  // namespace limber::editor
