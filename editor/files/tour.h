// SPDX-License-Identifier: AGPL-3.0-or-later
// A short walk through the editor on the sample arm: a bubble points at the real thing, and the step is over when it
// has been done. Where the user stopped is kept, and goes on there.
#pragma once

#include <string>
#include <vector>

#include "editor/context/tour_progress.h"

namespace limber::editor {

struct Editor;

struct TourStep {
  const char *title, *text, *widget, *operator_id;  // the operator gives the keys that are shown
  bool (*done)(const Editor&, const TourStart&);
};
const std::vector<TourStep>& tour_steps();

void start_tour(Editor& editor);
void go_to_step(Editor& editor, int step);  // beyond the last: the tour is over
void end_tour(Editor& editor);
// Once a frame: goes on when the step has been done.
void follow_tour(Editor& editor);

}  // namespace limber::editor
