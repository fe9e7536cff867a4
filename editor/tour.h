// SPDX-License-Identifier: AGPL-3.0-or-later
// A short walk through the editor on the sample arm: a bubble points at the real thing, and the step is over when it has
// been done. Where the user stopped is kept, and goes on there.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace limber::editor {

struct Editor;

// What a step compares with: the editor when the step began.
struct TourStart {
  glm::dquat turn{1, 0, 0, 0};
  glm::dvec3 cross_hair{0};
  std::int64_t position = 0;  // in the history
  int hidden = 0;             // tissues
  std::size_t results = 0;
  int statistics = 0;         // how often they were counted
};

struct Tour {
  bool shown = false;
  int step = 0;
  TourStart start;
};

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
