// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that find weight problems, step through them and repair them.
#include "editor/context/context.h"
#include "editor/skin/weight_problems.h"
#include "editor/ui/messages.h"

#include "editor/context/operator.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_weights(const Context& context) {
  if (std::string why = why_not_these_weights(context); !why.empty()) return why;
  return finds_problems(context.jobs) ? "The search for problems is running: wait until the job ends" : "";
}

std::string needs_problem(const Context& context) {
  if (std::string why = needs_weights(context); !why.empty()) return why;
  const Painting& painting = *context.skin->painting;
  if (!painting.problems || painting.problem < 0) return "Select a problem first";
  return painting.problems->repaired[static_cast<std::size_t>(painting.problem)]
             ? "This problem is already repaired: select another problem"
             : "";
}

// Shows a message that describes the problem in the views, because its row in the list may be scrolled out of view.
// The message replaces the message about the previous problem.
void tell_of_problem(Context& context) {
  constexpr std::string_view kLine = "Problem ";
  const Painting& painting = *context.skin->painting;
  const auto at = static_cast<std::size_t>(painting.problem);
  std::erase_if(context.messages->toasts, [&](const Toast& toast) { return toast.line.starts_with(kLine); });
  context.messages->info(
      std::string(kLine) + std::to_string(at + 1) + " of " + std::to_string(painting.problems->problems.size()),
      describe(painting.problems->problems[at], *painting.problems->armature));
}

// Goes to the next (by = 1) or previous (by = -1) problem that is not repaired. If there was no search for problems
// yet, starts one.
void step(Context& context, int by) {
  const Painting& painting = *context.skin->painting;
  if (!painting.problems) return start_finding_problems(context);
  const int count = static_cast<int>(painting.problems->problems.size());
  int at = painting.problem < 0 && by < 0 ? 0 : painting.problem;
  for (int tried = 0; tried < count; ++tried) {
    at = (at + by + count) % count;
    if (painting.problems->repaired[static_cast<std::size_t>(at)]) continue;
    go_to_problem(context, at);
    return tell_of_problem(context);
  }
  if (problems_stale(context)) return start_finding_problems(context);
  context.messages->info("Next problem", "All problems are repaired");
}

}  // namespace

std::vector<Operator> weight_problem_operators() {
  return {
      {"skin.find_problems", "Find problems", icon::kSearch, "Weights",
       "Find tissue that no bone reaches, isolated islands of weight, voxels that follow distant bones, bone tissue "
       "that bends, and abrupt changes.",
       start_finding_problems, needs_weights},
      {"skin.next_problem", "Next problem", icon::kWarning, "Weights",
       "Select the next problem of the weights and move the views to it. Searches for problems first if needed.",
       [](Context& c) { step(c, 1); }, needs_weights},
      {"skin.previous_problem", "Previous problem", "", "Weights",
       "Select the previous problem of the weights and move the views to it.", [](Context& c) { step(c, -1); },
       needs_weights},
      {"skin.repair_problem", "Repair problem", icon::kTick, "Weights",
       "Repair the problem selected in the list. Other weights do not change.",
       [](Context& c) { repair_problem(c, c.skin->painting->problem); }, needs_problem},
  };
}

}  // namespace limber::editor
