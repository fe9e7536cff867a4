// SPDX-License-Identifier: AGPL-3.0-or-later
// The girth of a limb or the trunk: the length of a tape around it in a plane. A tape bridges hollows, so the girth is
// the length of the convex hull of the plane's section through the body. All parts of the section that are connected to
// the given point are inside the tape.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "core/volume/label_volume.h"

namespace limber {

// Returns the corners of the tape around the body at a point, world, mm, in order around the body.
//   point   a point inside the body, or at most two voxels outside it; world, mm
//   normal  normal of the tape's plane, world, of any length
//   throws Error when there is no tissue at the point, or when the section reaches the border of the volume
std::vector<glm::dvec3> girth_tape(const LabelVolume& volume, const glm::dvec3& point, const glm::dvec3& normal);

// Returns the middle of the tissue along a straight line into the body that starts at a point on its surface; world,
// mm.
//   direction  direction of the line, world, of any length
glm::dvec3 middle_along(const LabelVolume& volume, const glm::dvec3& surface, const glm::dvec3& direction);

// Returns the unit normal of the plane through a point in which the girth is least, world. For a point in the middle of
// a limb, the normal is along the limb. For a point near the surface, the plane of least girth only cuts off a cap.
// Throws Error as girth_tape() does, if no plane has a complete section.
glm::dvec3 least_girth_normal(const LabelVolume& volume, const glm::dvec3& point);

}  // namespace limber
