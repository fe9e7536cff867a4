// SPDX-License-Identifier: AGPL-3.0-or-later
// Intersects the faces of a tet mesh with a plane. The resulting lines show the tets on a section through the body.
#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

#include "core/mesh/tet_mesh.h"

namespace limber {

// The two ends of a line segment, world, mm.
using Segment = std::array<glm::dvec3, 2>;

// Returns every face of the tets once, #F by 3 nodes.
Eigen::MatrixX3i faces_of(const Eigen::MatrixX4i& T);

// Returns one line segment for each face that the plane cuts, in order of the faces. A node on the plane counts as in
// front of it (on the side to which the normal points), so that lines meet and none is drawn twice.
//   V  #V by 3, mm      F  #F by 3      normal  of any length
std::vector<Segment> plane_cut(const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F, const glm::dvec3& point,
                               const glm::dvec3& normal);

// Clips the line segments to the half space behind the plane (opposite to its normal), and removes those in front.
void keep_behind(std::vector<Segment>& lines, const glm::dvec3& point, const glm::dvec3& normal);

}  // namespace limber
