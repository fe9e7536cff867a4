// SPDX-License-Identifier: AGPL-3.0-or-later
// Where a plane cuts the faces of a tet mesh: the lines by which a cut shows its tets.
#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

#include "core/mesh/tet_mesh.h"

namespace limber {

// A line between two places, world, mm.
using Segment = std::array<glm::dvec3, 2>;

// #F by 3: every face of the mesh once.
Eigen::MatrixX3i faces_of(const Eigen::MatrixX4i& T);

// One line for each face that the plane cuts, in order of the faces. Nodes on the plane count as beyond it, so that
// lines meet and none is drawn twice.
//   V  #V by 3, mm      F  #F by 3      normal  of any length
std::vector<Segment> plane_cut(const Eigen::MatrixX3d& V, const Eigen::MatrixX3i& F, const glm::dvec3& point,
                               const glm::dvec3& normal);

// What of the lines lies on the side of the plane away from its normal.
void keep_behind(std::vector<Segment>& lines, const glm::dvec3& point, const glm::dvec3& normal);

}  // namespace limber
