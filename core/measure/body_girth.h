// SPDX-License-Identifier: AGPL-3.0-or-later
// The girth of a limb or the trunk: the length of a tape around it, in a plane. As a tape does, it bridges hollows: it
// is the convex hull of the cut that the plane makes through the body. All parts of the cut that are connected to the
// given point are inside the tape.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "core/volume/label_volume.h"

namespace limber {

// Returns the corners of the tape around the body at a point, world, mm, in order around it.
//   point   a point inside the body, or at most two voxels beside it; world, mm
//   normal  normal of the tape's plane, world, of any length
//   throws Error when there is no tissue at the point, or when the cut reaches the border of the volume
std::vector<glm::dvec3> girth_tape(const LabelVolume& volume, const glm::dvec3& point, const glm::dvec3& normal);

// Returns the middle of the tissue that a straight line runs through, from a point at its surface; world, mm.
//   direction  of the line into the body, world, of any length
glm::dvec3 middle_along(const LabelVolume& volume, const glm::dvec3& surface, const glm::dvec3& direction);

// Returns the unit normal of the plane through a point in which the girth is least, world. For a point in the middle of
// a limb it is along the limb; through a point near the surface, the tape only cuts off a cap. Throws Error as
// girth_tape() does, when no plane has a whole cut.
glm::dvec3 least_girth_normal(const LabelVolume& volume, const glm::dvec3& point);

}  // namespace limber
