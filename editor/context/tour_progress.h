// SPDX-License-Identifier: AGPL-3.0-or-later
// How far the tour of the editor has come.
#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace limber::editor {

// What a step compares with: the editor when the step began.
struct TourStart {
  glm::dquat turn{1, 0, 0, 0};
  glm::dvec3 cross_hair{0};
  std::int64_t position = 0;  // in the history
  int hidden = 0;             // tissues
  std::size_t results = 0;
  int statistics = 0;  // how often they were counted
};

struct Tour {
  bool shown = false;
  int step = 0;
  TourStart start;
};

}  // namespace limber::editor
