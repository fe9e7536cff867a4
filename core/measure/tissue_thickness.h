// SPDX-License-Identifier: AGPL-3.0-or-later
// The thickness of a tissue at a point: the length of the shortest straight line through the point from border to
// border of the tissue. Lengths are averaged over nine parallel lines, one voxel apart, to reduce the effect of the
// voxels' stairs. For a layer such as skin or fat this is the layer's thickness, for a vessel its diameter.
#pragma once

#include <array>

#include <glm/glm.hpp>

#include "core/volume/label_volume.h"

namespace limber {

// Returns the two ends of the shortest line, world, mm.
//   voxel  a voxel of the tissue; the line passes through its centre
//   throws Error when there is no tissue at the voxel, or when the line ends at the border of the volume
std::array<glm::dvec3, 2> thickness_line(const LabelVolume& volume, const glm::ivec3& voxel);

}  // namespace limber
