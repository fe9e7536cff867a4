// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes how far a limb of two bones must bend so that its end has a given distance from its root.
#pragma once

#include <glm/glm.hpp>

namespace limber {

// Returns the angle, radians, about the unit vector `axis` by which the lower bone must be rotated so that its end is
// `wanted` mm from the root of the upper bone. Of the two solutions it returns the one in which the limb is bent by a
// positive angle.
//   upper, lower  vectors from the root to the middle joint and from there to the end, mm
double bend_for(const glm::dvec3& upper, const glm::dvec3& lower, const glm::dvec3& axis, double wanted);

}  // namespace limber
