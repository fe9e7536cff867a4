// SPDX-License-Identifier: AGPL-3.0-or-later
// A short tour of the editor on the sample arm. A bubble points at the widget of each step, and the step ends when the
// user has done what the bubble says. The current step is stored, so that the tour can resume at this step later.
#pragma once

#include <string>
#include <vector>

#include "editor/context/tour_progress.h"

namespace limber::editor {

struct Context;

struct TourStep {
  // Title and text of the bubble, the widget at which it points, the operator whose shortcut it shows.
  const char *title, *text, *widget, *operator_id;
  bool (*done)(const Context&, const TourStart&);
};
const std::vector<TourStep>& tour_steps();

void start_tour(Context& context);
void go_to_step(Context& context, int step);  // a step beyond the last ends the tour
void end_tour(Context& context);
// Goes to the tour's next step when the current step is done. Call once per frame.
void follow_tour(Context& context);

}  // namespace limber::editor
