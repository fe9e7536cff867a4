// SPDX-License-Identifier: AGPL-3.0-or-later
// The progress of the editor's guided tour.
#pragma once

#include <cstddef>
#include <cstdint>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace limber::editor {

// The editor's state when a step of the guided tour began. The step is done when the user has changed the part of the
// state that the step asks for.
struct TourStart {
  glm::dquat turn{1, 0, 0, 0};  // orientation of the 3D view's camera (world_from_view)
  glm::dvec3 cross_hair{0};
  std::int64_t position = 0;  // index of the history's current step
  int hidden = 0;             // number of tissues that were hidden
  std::size_t results = 0;
  int statistics = 0;  // number of times that the command Statistics had been run
};

struct Tour {
  bool shown = false;
  int step = 0;
  TourStart start;
};

}  // namespace limber::editor
