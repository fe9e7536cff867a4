// SPDX-License-Identifier: AGPL-3.0-or-later
// The rim of a brush laid upon the body: a circle about the place in the plane that touches it there, each of its
// points let down, or lifted, along the normal to where what is seen of the body begins. A point that finds nothing
// within the radius stays in the plane.
#pragma once

#include <vector>

#include "editor/skin/painting.h"

namespace limber::editor {

struct RingPoint {
  glm::dvec3 at{0};      // world, mm
  bool on_body = false;  // else in the plane
};

//   radius  mm, positive     returns  #count, even angles
std::vector<RingPoint> ring_on_body(const Editor& editor, const BrushPlace& place, double radius, int count);

}  // namespace limber::editor
