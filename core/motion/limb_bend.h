// SPDX-License-Identifier: AGPL-3.0-or-later
// By how much a limb of two bones must bend so that its end has a given distance from its root.
#pragma once

#include <glm/glm.hpp>

namespace limber {

// Returns the angle about a unit axis, radians, by which the lower bone must be turned so that the limb's joint is
// `wanted` mm away from its root. Of the two angles that are, it is the one that leaves the limb bent towards positive
// angles.
//   upper, lower  vectors from root to middle and from middle to joint, mm
double bend_for(const glm::dvec3& upper, const glm::dvec3& lower, const glm::dvec3& axis, double wanted);

}  // namespace limber
