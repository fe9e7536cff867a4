// SPDX-License-Identifier: AGPL-3.0-or-later
// A bar of flesh with two bones in it that meet at a joint halfway, for tests of finite element solves.
#pragma once

#include <cmath>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "core/fem/solve_pose.h"
#include "tests/support/tet_shapes.h"

namespace limber {

struct BarModel {
  double length = 120, width = 36, gap = 24;  // mm; each bone ends gap / 2 from the joint, which is at the origin
  FemModel fem;

  explicit BarModel(int along = 20, int across = 6, double poisson_ratio = 0.499) {
    fem.mesh =
        kuhn_box(across, across, along, {-width / 2, -width / 2, -length / 2}, {width / 2, width / 2, length / 2});
    fem.material.assign(fem.mesh.T.rows(), {4, poisson_ratio});
    fem.bone_names = {"Upper", "Lower"};
    const double reach = 1.1 * width / across;  // half width of a bone, mm: flesh cannot spin around such a thick bone
    for (Eigen::Index v = 0; v < fem.mesh.V.rows(); ++v) {
      const Eigen::RowVector3d p = fem.mesh.V.row(v);
      const bool bone = std::abs(p[0]) < reach && std::abs(p[1]) < reach && std::abs(p[2]) >= gap / 2;
      fem.held_by.push_back(!bone ? -1 : p[2] < 0 ? 0 : 1);
      const double lower = std::min(1.0, std::max(0.0, 0.5 + p[2] / width));
      fem.influences.push_back({});
      if (lower < 1) fem.influences.back().push_back({0, 1 - lower});
      if (lower > 0) fem.influences.back().push_back({1, lower});
    }
  }

  // Returns the motion in which the lower bone turns about x.
  BonePath bend(double degrees, double from_degrees = 0) const {
    return [=](double t) {
      const double angle = glm::radians(from_degrees + (degrees - from_degrees) * t);
      return std::vector<RigidTransform>{{}, rotation_about(glm::dvec3(0), glm::angleAxis(angle, glm::dvec3(1, 0, 0)))};
    };
  }
  // Returns the motion in which the lower bone moves towards the upper bone.
  BonePath push(double mm) const {
    return [=](double t) {
      return std::vector<RigidTransform>{{}, {glm::dquat(1, 0, 0, 0), glm::dvec3(0, 0, -mm * t)}};
    };
  }
};

// Counts the pairs of an edge and a triangle of the mesh's surface that pass through each other and share no node.
// Every pair is tested.
inline int skin_crossings(const TetMesh& mesh, const Eigen::MatrixX3d& V) {
  const Eigen::MatrixX3i F = boundary_of(mesh.T);
  std::vector<std::array<int, 2>> edges;
  for (const auto& f : F.rowwise())
    for (int k = 0; k < 3; ++k)
      if (f[k] < f[(k + 1) % 3]) edges.push_back({f[k], f[(k + 1) % 3]});
  const auto volume = [&](int a, int b, int c, int d) {
    const Eigen::RowVector3d o = V.row(a);
    return (V.row(b) - o).dot((V.row(c) - o).cross(V.row(d) - o));
  };
  int crossings = 0;
  for (const auto& f : F.rowwise()) {
    const Eigen::RowVector3d low = V.row(f[0]).cwiseMin(V.row(f[1])).cwiseMin(V.row(f[2])),
                             high = V.row(f[0]).cwiseMax(V.row(f[1])).cwiseMax(V.row(f[2]));
    for (const auto& [a, b] : edges) {
      if ((f.array() == a).any() || (f.array() == b).any()) continue;
      if ((V.row(a).cwiseMin(V.row(b)).array() > high.array()).any() ||
          (V.row(a).cwiseMax(V.row(b)).array() < low.array()).any())
        continue;
      if (volume(a, f[0], f[1], f[2]) * volume(b, f[0], f[1], f[2]) > 0) continue;
      const double u = volume(a, b, f[0], f[1]), v = volume(a, b, f[1], f[2]), w = volume(a, b, f[2], f[0]);
      crossings += (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
    }
  }
  return crossings;
}

}  // namespace limber
