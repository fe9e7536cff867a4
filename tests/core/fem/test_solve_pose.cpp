// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/solve_pose.h"

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/mesh/crossings.h"
#include "tests/support/fem_models.h"

using namespace limber;

namespace {
double volume_of(const TetMesh& mesh, const Eigen::MatrixX3d& V) {
  double sum = 0;
  for (const auto& tet : mesh.T.rowwise()) sum += signed_volume(V, tet);
  return sum;
}

double furthest_from_target(const FemModel& model, const std::vector<RigidTransform>& pose, const Eigen::MatrixX3d& V) {
  double most = 0;
  for (Eigen::Index v = 0; v < V.rows(); ++v)
    if (const int bone = model.held_by[v]; bone >= 0) {
      const glm::dvec3 to = pose[bone] * glm::dvec3(model.mesh.V(v, 0), model.mesh.V(v, 1), model.mesh.V(v, 2));
      most = std::max(most, (V.row(v) - Eigen::RowVector3d(to.x, to.y, to.z)).norm());
    }
  return most;
}

class CancelAfter : public Progress {
 public:
  explicit CancelAfter(int updates) : left_(updates) {}

 private:
  void on_update(std::string_view, double) override {
    if (--left_ == 0) cancel();
  }
  int left_;
};
}  // namespace

TEST_CASE("solve pose: a bar of flesh bends, keeps its volume and holds its bones, not one tet inverts on the way") {
  const BarModel bar;
  double reached = 0;
  int calls = 0;
  const SolvedPose solved = solve_pose(bar.fem, bar.bend(60), 60, {}, no_progress(), [&](const SolveStep& step) {
    CHECK(step.reached >= reached);
    CHECK(step.V.rows() == bar.fem.mesh.V.rows());
    reached = step.reached;
    ++calls;
  });
  CHECK(solved.converged);
  CHECK(solved.reached == 1);
  CHECK(solved.blocked_by.empty());
  CHECK(solved.steps == 3);
  CHECK(solved.inverted == 0);
  CHECK(solved.min_det_f > 0.05);
  CHECK(solved.residual < 0.3);
  CHECK(calls == solved.iterations);
  CHECK(furthest_from_target(bar.fem, bar.bend(60)(1), solved.V) < 0.05);
  CHECK(std::abs(volume_of(bar.fem.mesh, solved.V) / volume_of(bar.fem.mesh, bar.fem.mesh.V) - 1) < 0.002);
}

TEST_CASE("solve pose: flesh of Poisson ratio 0.3 loses many times the volume") {
  const auto lost = [](double nu) {
    const BarModel bar(20, 6, nu);
    const SolvedPose solved = solve_pose(bar.fem, bar.bend(60), 60);
    REQUIRE(solved.converged);
    return std::abs(volume_of(bar.fem.mesh, solved.V) / volume_of(bar.fem.mesh, bar.fem.mesh.V) - 1);
  };
  CHECK(lost(0.3) > 10 * lost(0.499));
}

TEST_CASE("solve pose: at rest every node stays, to the last bit") {
  const BarModel bar(10, 4);
  for (const bool contact : {false, true}) {
    const SolvedPose solved = solve_pose(bar.fem, bar.bend(0), 0, {.contact = contact});
    CHECK(solved.converged);
    CHECK(solved.V == bar.fem.mesh.V);
  }
}

TEST_CASE("solve pose: without contact the skin passes through itself, with contact it does not, at any iteration") {
  const BarModel bar;
  const SolvedPose without = solve_pose(bar.fem, bar.bend(125), 125);
  CHECK(without.converged);
  CHECK(skin_crossings(bar.fem.mesh, without.V) > 0);
  const Eigen::MatrixX3i skin = boundary_of(bar.fem.mesh.T);
  const SolvedPose with = solve_pose(bar.fem, bar.bend(125), 125, {.contact = true}, no_progress(),
                                     [&](const SolveStep& step) { CHECK(crossing_pairs(step.V, skin).empty()); });
  CHECK(with.converged);
  CHECK(with.inverted == 0);
  CHECK(with.iterations < 60);
  CHECK(skin_crossings(bar.fem.mesh, with.V) == 0);
  CHECK(furthest_from_target(bar.fem, bar.bend(125)(1), with.V) < 0.5);
}

TEST_CASE("solve pose: the same for one thread and two, bit for bit") {
  const BarModel bar;
  Eigen::MatrixX3d first;
  for (const int threads : {1, 2}) {
    const ThreadCount count(threads);
    const SolvedPose solved = solve_pose(bar.fem, bar.bend(40), 40, {.contact = true});
    if (threads == 1) first = solved.V;
    CHECK(solved.V == first);
  }
}

TEST_CASE("solve pose: from a neighbouring pose it ends where it ends from rest") {
  const BarModel bar;
  const SolveSettings accurate{.tolerance_mm = 0.0001};
  const SolvedPose near = solve_pose(bar.fem, bar.bend(8), 8, accurate),
                   far = solve_pose(bar.fem, bar.bend(16), 16, accurate);
  const SolvedPose further = solve_pose(bar.fem, bar.bend(16, 8), 8, accurate, no_progress(), {}, &near.V);
  CHECK(further.converged);
  CHECK(further.steps == 1);
  CHECK((further.V - far.V).rowwise().norm().maxCoeff() < 0.001);
}

TEST_CASE("solve pose: flesh that waits goes with its bone until then, and the shape is the same in the end" *
          doctest::test_suite("slow")) {
  const BarModel bar;
  FemModel waits = bar.fem;
  for (int v = 0; v < int(waits.mesh.V.rows()); ++v)
    if (waits.held_by[v] < 0 && std::abs(waits.mesh.V(v, 2)) > 30)
      waits.waiting.push_back({v, waits.mesh.V(v, 2) < 0 ? 0 : 1, 0.5});
  const SolveSettings accurate{.contact = true, .step_degrees = 10, .tolerance_mm = 0.0001};
  const BonePath path = bar.bend(40);
  double furthest = 0;
  int before = 0, after = 0;
  const SolvedPose solved = solve_pose(waits, path, 40, accurate, no_progress(), [&](const SolveStep& step) {
    double off = 0;
    for (const auto& [node, bone, until] : waits.waiting) {
      const glm::dvec3 to =
          path(step.reached)[bone] * glm::dvec3(waits.mesh.V(node, 0), waits.mesh.V(node, 1), waits.mesh.V(node, 2));
      off = std::max(off, (step.V.row(node) - Eigen::RowVector3d(to.x, to.y, to.z)).norm());
    }
    if (step.reached <= 0.5) furthest = std::max(furthest, off), ++before;
    else after += off > 0.1;
  });
  CHECK(before > 0);
  CHECK(furthest < 0.05);
  CHECK(after > 0);
  CHECK(solved.converged);
  CHECK(solved.iterations == solved.factorizations);
  const SolvedPose at_once = solve_pose(bar.fem, path, 40, accurate);
  CHECK((solved.V - at_once.V).rowwise().norm().maxCoeff() < 0.001);

  SUBCASE("the same for one thread and two") {
    const ThreadCount two(2);
    CHECK(solve_pose(waits, path, 40, accurate).V == solved.V);
  }
  SUBCASE("a node that a bone holds cannot wait") {
    waits.waiting.push_back(
        {int(std::find(waits.held_by.begin(), waits.held_by.end(), 0) - waits.held_by.begin()), 0, 0.5});
    CHECK_THROWS_AS(solve_pose(waits, path, 40), Error);
  }
}

TEST_CASE("solve pose: a flap that hangs by an edge, and what hangs by nothing, go with the bones that they follow") {
  BarModel bar;
  // Adds two tets at the skin of the lower half: one shares two nodes with the bar, one none.
  TetMesh& mesh = bar.fem.mesh;
  const auto first = mesh.V.rows(), tets = mesh.T.rows();
  std::vector<int> edge;
  for (int v = 0; v < int(first) && edge.size() < 2; ++v)
    if (mesh.V(v, 0) > 0.49 * bar.width && mesh.V(v, 2) > 40 &&
        (edge.empty() || std::abs(mesh.V(v, 2) - mesh.V(edge[0], 2)) < 1e-9))
      edge.push_back(v);
  REQUIRE(edge.size() == 2);
  mesh.V.conservativeResize(first + 6, 3);
  const Eigen::RowVector3d middle = 0.5 * (mesh.V.row(edge[0]) + mesh.V.row(edge[1]));
  mesh.V.row(first) = middle + Eigen::RowVector3d(8, 0, -3);
  mesh.V.row(first + 1) = middle + Eigen::RowVector3d(8, 0, 3);
  for (int k = 0; k < 4; ++k)
    mesh.V.row(first + 2 + k) = middle + Eigen::RowVector3d(20 + 6 * (k == 1), 6 * (k == 2), 6 * (k == 3));
  mesh.T.conservativeResize(tets + 2, 4);
  mesh.T.row(tets) << edge[0], edge[1], first, first + 1;
  mesh.T.row(tets + 1) << first + 2, first + 3, first + 4, first + 5;
  if (count_inverted(mesh.T, mesh.V)) std::swap(mesh.T(tets, 2), mesh.T(tets, 3));
  REQUIRE(count_inverted(mesh.T, mesh.V) == 0);
  bar.fem.material.resize(tets + 2, bar.fem.material[0]);
  bar.fem.held_by.resize(first + 6, -1);
  bar.fem.influences.resize(first + 6, {{1, 1.0}});
  const BonePath path = bar.bend(50);
  const SolvedPose solved = solve_pose(bar.fem, path, 50);
  CHECK(solved.converged);
  const RigidTransform lower = path(1)[1];
  for (auto v = first; v < first + 6; ++v) {
    const glm::dvec3 to = lower * glm::dvec3(mesh.V(v, 0), mesh.V(v, 1), mesh.V(v, 2));
    CHECK((solved.V.row(v) - Eigen::RowVector3d(to.x, to.y, to.z)).norm() < 2.5);
  }
}

TEST_CASE("solve pose: a pose out of reach ends at the last good step and says what is in the way") {
  const BarModel bar;  // its bones are 24 mm apart, so that they cannot come 40 mm nearer
  const SolvedPose solved = solve_pose(bar.fem, bar.push(40), 45);
  CHECK_FALSE(solved.converged);
  CHECK(solved.reached > 0.2);
  CHECK(solved.reached < 0.7);
  CHECK(solved.inverted == 0);
  INFO(solved.blocked_by);
  CHECK(solved.blocked_by.find("Upper") != std::string::npos);
  CHECK(solved.V.allFinite());
  for (const auto& tet : bar.fem.mesh.T.rowwise()) REQUIRE(signed_volume(solved.V, tet) > 0);
  CHECK(furthest_from_target(bar.fem, bar.push(40)(solved.reached), solved.V) < 2);
}

TEST_CASE("solve pose: a cancelled solve ends at once") {
  const BarModel bar;
  CancelAfter progress(4);
  CHECK_THROWS_AS(solve_pose(bar.fem, bar.bend(60), 60, {.contact = true}, progress), Cancelled);
}

TEST_CASE("solve pose: lists that do not fit the mesh and inverted tets are refused") {
  BarModel bar(4, 2);
  bar.fem.material.pop_back();
  CHECK_THROWS_AS(solve_pose(bar.fem, bar.bend(10), 10), Error);
  bar.fem.material.push_back({});
  std::swap(bar.fem.mesh.T(0, 0), bar.fem.mesh.T(0, 1));
  CHECK_THROWS_AS(solve_pose(bar.fem, bar.bend(10), 10), Error);
}
