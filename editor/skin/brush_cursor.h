// SPDX-License-Identifier: AGPL-3.0-or-later
// Projects the brush's circle onto the body. The circle lies in the plane that touches the body at the brush's centre.
// Each point of the circle is moved along the plane's normal to the visible surface. A point with no surface within the
// brush's radius stays in the plane.
#pragma once

#include <vector>

#include <glm/glm.hpp>

namespace limber::editor {

struct BrushPlace;
struct Views;

struct RingPoint {
  glm::dvec3 at{0};      // position of the point in the world, mm
  bool on_body = false;  // false: no surface was found, the point lies in the tangent plane
};

// Returns `count` points of the projected circle at equal angles. radius: mm, positive.
std::vector<RingPoint> ring_on_body(const Views& views, const BrushPlace& place, double radius, int count);

}  // namespace limber::editor
