// SPDX-License-Identifier: AGPL-3.0-or-later
// Twists and bends round bars made of voxels and meshed like bodies. Their moments are known analytically. Moments grow
// with the fourth power of the radius, so they reveal a mesh that is too thick or too thin, and tets that are too
// stiff.
#include <array>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>
#include <Eigen/Geometry>

#include "core/fem/fem_energy.h"
#include "core/fem/newton.h"
#include "core/mesh/mesh_tissue.h"
#include "core/mesh/tet_mesh.h"

using namespace limber;

namespace {

constexpr double kRadius = 40, kLength = 200, kHeld = 40;  // mm; a length of kHeld is held at each end
constexpr double kPoisson = 0.45;

// Makes a bar along z, in voxels of 2 mm whose centres do not lie on its axis.
LabelVolume bar() {
  const int across = 54, along = 110;
  LabelVolume volume{{{across, across, along}, {2, 2, 2}, {}, glm::dmat3(1)}, {}};
  volume.grid.origin = {-across + 1.3, -across + 0.6, -0.5 * (2 * along - kLength)};
  volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count(), 0);
  glm::ivec3 v;
  for (v.z = 0; v.z < along; ++v.z)
    for (v.y = 0; v.y < across; ++v.y)
      for (v.x = 0; v.x < across; ++v.x) {
        const glm::dvec3 p = world_from_voxel(volume.grid) * glm::dvec3(v);
        if (p.z > 0 && p.z < kLength && std::hypot(p.x, p.y) < kRadius) volume.at(v) = 1;
      }
  return volume;
}

using Shape = Eigen::RowVector3d (*)(const Eigen::RowVector3d& rest);

// Returns the moment in kPa mm3 of the forces that hold the upper end, about axis `axis` (0 to 2) through the bar's
// middle line, when both ends are held in the given shape. The shear modulus is 1 kPa.
double moment(const TetMesh& mesh, const Shape& shape, int axis) {
  const NodePositions rest = mesh.V;
  FemEnergy energy(rest, mesh.T, std::vector<TetMaterial>(mesh.T.rows(), {1, kPoisson}), 0);
  PinForm pins;
  for (int v = 0; v < int(rest.rows()); ++v)
    if (rest(v, 2) < kHeld || rest(v, 2) > kLength - kHeld) pins.node.push_back(v);
  pins.stiffness = NodePositions::Constant(std::ssize(pins.node), 3, 1e6);
  pins.target.resize(std::ssize(pins.node), 3);
  NodePositions x = rest;
  for (int v = 0; v < int(rest.rows()); ++v) x.row(v) = shape(rest.row(v));
  for (std::size_t k = 0; k < pins.node.size(); ++k) pins.target.row(k) = x.row(pins.node[k]);
  energy.set_constraints(pins, {}, {});
  REQUIRE(minimise(energy, x, {.tolerance_mm = 1e-7}).converged);

  NodePositions force = NodePositions::Zero(x.rows(), 3);
  pins.add_gradient(x, force);
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (const int v : pins.node)
    if (rest(v, 2) > kLength / 2) {
      const Eigen::RowVector3d at = x.row(v) - Eigen::RowVector3d(0, 0, kLength / 2), pull = -force.row(v);
      sum += at.cross(pull);
    }
  return sum[axis];
}

constexpr double kTwist = 2e-4;      // rotation of the cross sections per length, radians / mm
constexpr double kCurvature = 1e-4;  // curvature of the bar's middle line, 1 / mm

Eigen::RowVector3d twisted(const Eigen::RowVector3d& p) {
  const double angle = kTwist * (p[2] - kLength / 2), c = std::cos(angle), s = std::sin(angle);
  return {c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
}

// Returns the position of a point of the bar in pure bending about y, to first order [Timoshenko & Goodier, Theory of
// Elasticity, 1970, section 102].
Eigen::RowVector3d bent(const Eigen::RowVector3d& p) {
  const double z = p[2] - kLength / 2;
  return p + kCurvature * Eigen::RowVector3d(0.5 * (z * z + kPoisson * (p[0] * p[0] - p[1] * p[1])),
                                             kPoisson * p[0] * p[1], -p[0] * z);
}

}  // namespace

TEST_CASE(
    "verification: a round bar of voxels resists torsion and bending as on paper, the more so the finer its tets" *
    doctest::test_suite("slow")) {
  const LabelVolume volume = bar();
  const double second_moment = std::numbers::pi * std::pow(kRadius, 4) / 4;
  const double torque = 2 * second_moment * kTwist;
  const double bending = 2 * (1 + kPoisson) * second_moment * kCurvature;
  // Linear tets are too stiff. The error falls with the square of their size.
  std::array<double, 2> before{INFINITY, INFINITY}, limit{};
  double size_before = 0;
  for (const double spacing : {12.0, 8.0, 5.0}) {  // mm: for a limb of this thickness at quality draft, normal and fine
    CAPTURE(spacing);
    const TissueMesh meshed = mesh_tissue(volume, {.spacing_mm = spacing});
    const std::array<double, 2> error{moment(meshed.mesh, twisted, 2) / torque - 1,
                                      moment(meshed.mesh, bent, 1) / bending - 1};
    MESSAGE(spacing, " mm: torsion ", 100 * error[0], " %, bending ", 100 * error[1], " %, ", meshed.mesh.T.rows(),
            " tets");
    for (int k = 0; k < 2; ++k) {
      CHECK(std::abs(error[k]) < 0.01 + std::pow(spacing / kRadius, 2));
      CHECK(std::abs(error[k]) < before[k]);
      // Extrapolates the error to tets of size zero.
      if (size_before > 0) limit[k] = error[k] - (before[k] - error[k]) / (std::pow(size_before / spacing, 2) - 1);
    }
    before = error;
    size_before = spacing;
  }
  MESSAGE("without the tets' size: torsion ", 100 * limit[0], " %, bending ", 100 * limit[1], " %");
  for (const double error : limit) CHECK(std::abs(error) < 0.02);
}
