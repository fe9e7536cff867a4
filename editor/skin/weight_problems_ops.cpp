// SPDX-License-Identifier: AGPL-3.0-or-later
// What is wrong with weights is found, gone to and repaired.
#include "editor/skin/weight_problems.h"

#include <algorithm>

#include "editor/context/operator.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_weights(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Works in the Skin workspace";
  if (!seen_weights(editor)) return "Compute the weights first";
  const auto& bones = editor.document().armature->bones;
  const auto& names = editor.document().weights->bones();
  if (!std::equal(bones.begin(), bones.end(), names.begin(), names.end(),
                  [](const Bone& bone, const std::string& name) { return bone.name == name; }))
    return "The weights belong to another rig";
  return finds_problems(editor) ? "They are being looked for" : "";
}

std::string needs_problem(const Editor& editor) {
  if (std::string why = needs_weights(editor); !why.empty()) return why;
  const Painting& painting = *editor.skin->painting;
  if (!painting.problems || painting.problem < 0) return "Go to a problem first";
  return painting.problems->repaired[static_cast<std::size_t>(painting.problem)] ? "It is repaired" : "";
}

// Those that are repaired are passed over; without a list it is made first.
void step(Editor& editor, int by) {
  const Painting& painting = *editor.skin->painting;
  if (!painting.problems) return start_finding_problems(editor);
  const int count = static_cast<int>(painting.problems->problems.size());
  int at = painting.problem < 0 && by < 0 ? 0 : painting.problem;
  for (int tried = 0; tried < count; ++tried) {
    at = (at + by + count) % count;
    if (!painting.problems->repaired[static_cast<std::size_t>(at)]) return go_to_problem(editor, at);
  }
  if (problems_stale(editor)) return start_finding_problems(editor);
  editor.messages.info("Next problem", "Nothing is left to repair");
}

}  // namespace

std::vector<Operator> weight_problem_operators() {
  return {
      {"skin.find_problems", "Find problems", icon::kSearch, "Weights",
       "Looks for tissue that no bone reaches, islands, bones that are far apart, bone tissue that bends, abrupt "
       "changes.",
       start_finding_problems, needs_weights},
      {"skin.next_problem", "Next problem", icon::kWarning, "Weights",
       "Goes to the next place where something is wrong with the weights; looks for them first.",
       [](Editor& e) { step(e, 1); }, needs_weights},
      {"skin.previous_problem", "Previous problem", "", "Weights", "Goes to the place before.",
       [](Editor& e) { step(e, -1); }, needs_weights},
      {"skin.repair_problem", "Repair problem", icon::kTick, "Weights",
       "Repairs the place that was gone to; other weights stay.",
       [](Editor& e) { repair_problem(e, e.skin->painting->problem); }, needs_problem},
  };
}

}  // namespace limber::editor
