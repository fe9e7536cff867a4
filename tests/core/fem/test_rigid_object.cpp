// SPDX-License-Identifier: AGPL-3.0-or-later
// A rigid plate presses on a column of flesh whose foot is held. The force is known analytically.
#include "core/fem/rigid_object.h"

#include <cmath>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/fem/solve_pose.h"
#include "core/mesh/mesh_tissue.h"
#include "core/mesh/surface_shapes.h"

using namespace limber;

namespace {

constexpr double kWidth = 60, kHeight = 120, kFoot = 8;  // mm: size of the column, and height of its held foot

// Makes a column along z from the origin, in voxels of 2 mm.
LabelVolume column() {
  LabelVolume volume{{{40, 40, 70}, {2, 2, 2}, {-9, -9, -9}, glm::dmat3(1)}, {}};
  volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count(), 0);
  glm::ivec3 v;
  for (v.z = 0; v.z < 70; ++v.z)
    for (v.y = 0; v.y < 40; ++v.y)
      for (v.x = 0; v.x < 40; ++v.x) {
        const glm::dvec3 p = world_from_voxel(volume.grid) * glm::dvec3(v);
        if (p.x > 0 && p.x < kWidth && p.y > 0 && p.y < kWidth && p.z > 0 && p.z < kHeight) volume.at(v) = 1;
      }
  return volume;
}

constexpr double kShear = 10, kPoisson = 0.3;  // shear modulus in kPa, Poisson's ratio

struct Pressed {
  FemModel model;
  SolvedPose solved;
};

// Moves a plate from above down to the height `to`, mm.
Pressed press(double to, const SolveSettings& settings) {
  Pressed pressed;
  FemModel& model = pressed.model;
  model.mesh = mesh_tissue(column(), {.spacing_mm = 12}).mesh;
  model.material.assign(model.mesh.T.rows(), {kShear, kPoisson});
  for (const auto& node : model.mesh.V.rowwise()) model.held_by.push_back(node[2] < kFoot ? 0 : -1);
  model.influences.assign(model.mesh.V.rows(), {{0, 1.0}});
  const TriangleMesh plate = plane_surface(120, 120);
  RigidObjects& objects = model.objects;
  objects.rest.resize(std::ssize(plate.V), 3);
  for (std::size_t v = 0; v < plate.V.size(); ++v)
    objects.rest.row(Eigen::Index(v)) << plate.V[v].x + kWidth / 2, plate.V[v].y + kWidth / 2, 1000;
  objects.F.resize(std::ssize(plate.F), 3);
  for (std::size_t f = 0; f < plate.F.size(); ++f)
    objects.F.row(Eigen::Index(f)) << plate.F[f].x, plate.F[f].z, plate.F[f].y;  // the outside of the plate faces down
  objects.object.assign(plate.V.size(), 0);
  objects.name = {"plate"};
  objects.at = [rest = objects.rest, to](double t) {
    NodePositions there = rest;
    there.col(2).setConstant(kHeight + 3 + t * (to - kHeight - 3));
    return there;
  };
  pressed.solved = solve_pose(
      model, [](double) { return std::vector<RigidTransform>(1); }, 45, settings);
  return pressed;
}

SolveSettings exact() {
  return {.contact = true, .contact_mm = 0.5, .object_mm = 0.2, .step_tolerance_mm = 0.5, .tolerance_mm = 1e-5};
}

// Returns the mean height of the nodes that were at the top of the column at rest.
double top(const FemModel& model, const Eigen::MatrixX3d& V) {
  double sum = 0;
  int count = 0;
  for (Eigen::Index v = 0; v < V.rows(); ++v)
    if (model.mesh.V(v, 2) > kHeight - 2) sum += V(v, 2), ++count;
  return sum / count;
}

}  // namespace

TEST_CASE("rigid object: a plate presses a column by what its stiffness takes, and all of it passes through the foot") {
  for (const double to : {117.0, 114.0}) {
    CAPTURE(to);
    const Pressed pressed = press(to, exact());
    REQUIRE(pressed.solved.converged);
    const double shorter = top(pressed.model, pressed.model.mesh.V) - top(pressed.model, pressed.solved.V);
    // The expected force is that on a column on a smooth floor, by Hooke's law. A column whose foot cannot widen is a
    // little stiffer, and gets stiffer when it is shorter and wider.
    const double young = 2 * kShear * (1 + kPoisson), strain = shorter / (kHeight - kFoot),
                 expected = 1e-3 * young * kWidth * kWidth * strain;
    const double force = 1e-3 * pressed.solved.force_on_objects.col(2).sum();
    CHECK(force > expected);
    CHECK(force < expected * (1.08 + strain));
    // The force on the skin is opposite and equal to that on the plate. Nothing pushes sideways.
    CHECK(1e-3 * pressed.solved.force_on_skin.col(2).sum() == doctest::Approx(-force).epsilon(1e-9));
    CHECK(std::abs(pressed.solved.force_on_objects.col(0).sum()) < 1e-2 * 1e3 * force);
    CHECK(std::abs(pressed.solved.force_on_objects.col(1).sum()) < 1e-2 * 1e3 * force);
    // No node has passed the plate, and the remaining gap is within the thickness of the barrier.
    CHECK(pressed.solved.V.col(2).maxCoeff() < to);
    CHECK(pressed.solved.V.col(2).maxCoeff() > to - 0.2);
  }
}

TEST_CASE("rigid object: gravity presses a column on its foot, and its head sinks as on paper") {
  Pressed pressed = press(kHeight + 2, exact());
  FemModel& model = pressed.model;
  double volume = 0;
  model.mass.assign(model.mesh.V.rows(), 0);
  for (Eigen::Index t = 0; t < model.mesh.T.rows(); ++t) {
    const double mm3 = signed_volume(model.mesh.V, model.mesh.T.row(t));
    volume += mm3;
    for (const int v : model.mesh.T.row(t)) model.mass[v] += 1e-6 * mm3 / 4;  // kg, at the density of water
  }
  SolveSettings settings = exact();
  settings.gravity = {0, 0, -9.80665};
  const SolvedPose solved = solve_pose(
      model, [](double) { return std::vector<RigidTransform>(1); }, 45, settings);
  REQUIRE(solved.converged);
  // A column of length L, density r and Young's modulus E sinks at its top by r g L^2 / (2 E).
  const double length = kHeight - kFoot, young = 2 * kShear * (1 + kPoisson),
               expected = 1e-3 * 9.80665 * length * length / (2 * young);
  const double sunk = top(model, model.mesh.V) - top(model, solved.V);
  CHECK(volume == doctest::Approx(kWidth * kWidth * kHeight).epsilon(0.06));  // the tets are coarse
  CHECK(sunk == doctest::Approx(expected).epsilon(0.1));
}

TEST_CASE("rigid object: one and two threads give the same bytes") {
  std::vector<SolvedPose> solved;
  for (const int threads : {1, 2}) {
    const ThreadCount count(threads);
    solved.push_back(press(116, exact()).solved);
  }
  CHECK(solved[0].V == solved[1].V);
  CHECK(solved[0].force_on_objects == solved[1].force_on_objects);
}
