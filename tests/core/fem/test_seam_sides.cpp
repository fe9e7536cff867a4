// SPDX-License-Identifier: AGPL-3.0-or-later
// Two bars touch along a seam and are one at their foot, as two thighs are. One bar bends away from the other.
#include "core/fem/seam_sides.h"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>
#include <glm/gtc/constants.hpp>

#include "core/fem/solve_pose.h"
#include "core/mesh/crossings.h"
#include "core/mesh/mesh_tissue.h"

using namespace limber;

namespace {

constexpr int kWide = 12, kDeep = 12, kLong = 40, kFoot = 12;  // voxels of 3 mm: each bar, and the common foot
constexpr double kVoxel = 3;

// The label of each voxel is 1 + its side if `sided`, else 1.
LabelVolume bars(bool sided) {
  LabelVolume volume{{{2 * kWide, kDeep, kLong}, glm::dvec3(kVoxel), glm::dvec3(0), glm::dmat3(1)}, {}};
  volume.voxels = ZeroedVector<Label>(volume.grid.voxel_count(), 1);
  glm::ivec3 v;
  for (v.z = 0; v.z < kLong && sided; ++v.z)
    for (v.y = 0; v.y < kDeep; ++v.y)
      for (v.x = kWide; v.x < 2 * kWide; ++v.x) volume.at(v) = static_cast<Label>(1 + soft_region(1));
  return volume;
}

std::shared_ptr<const Seams> seam(const LabelVolume& volume) {
  auto seams = std::make_shared<Seams>(volume.grid.size);
  for (int z = kFoot; z < kLong; ++z)
    for (int y = 0; y < kDeep; ++y) seams->cut({kWide - 1, y, z}, 0);
  return seams;
}

// Each half of the body follows a bone of its own.
SkinWeights halves(const TissueVoxels& tissue) {
  SkinWeights weights({"left", "right"}, tissue);
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
    SkinWeights::Influences chunk = weights.chunk(brick);
    auto influence = chunk.begin();
    tissue.for_each(brick, brick + 1,
                    [&](std::int64_t, const glm::ivec3& v) { *influence++ = rigid_influence(v.x >= kWide); });
    weights.set_chunk(brick, std::move(chunk));
  }
  return weights;
}

constexpr double kTop = kVoxel * (kLong - 3);  // mm: the tops of the bars, which the bones hold

// Turns the top of the second bar away from the first by 40 degrees, and returns the largest stretch of an edge.
double stretch_of(const TetMesh& mesh, SolvedPose& solved) {
  FemModel model;
  model.mesh = mesh;
  model.material.assign(mesh.T.rows(), {10, 0.4});
  const double middle = kVoxel * (kWide - 0.5);
  for (const auto& node : mesh.V.rowwise()) {
    model.held_by.push_back(node[2] < kVoxel || (node[2] > kTop && node[0] < middle) ? 0 : node[2] > kTop ? 1 : -1);
    model.influences.push_back({{node[0] > middle, 1.0}});
  }
  const glm::dvec3 pivot(middle, 0, kVoxel * kFoot);
  const BonePath path = [&](double t) {
    const glm::dquat turn = glm::angleAxis(t * glm::radians(40.0), glm::dvec3(0, 1, 0));
    return std::vector<RigidTransform>{{}, {turn, pivot - turn * pivot}};
  };
  solved = solve_pose(model, path, 40, {.contact = true});
  double largest = 0;
  for (const auto& tet : mesh.T.rowwise())
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b)
        largest = std::max(largest, (solved.V.row(tet[a]) - solved.V.row(tet[b])).norm() /
                                        (mesh.V.row(tet[a]) - mesh.V.row(tet[b])).norm());
  return largest;
}

}  // namespace

TEST_CASE("seam sides: the bones on both sides of a seam differ") {
  const LabelVolume volume = bars(false);
  TissueVoxels tissue(volume);
  const SkinWeights weights = halves(tissue);
  CHECK(sides_of_seams(tissue, weights, {0, 1}).empty());
  tissue.set_seams(seam(volume));
  CHECK(sides_of_seams(tissue, weights, {0, 1}) == std::vector<std::uint16_t>{0, 1});
  CHECK(sides_of_seams(tissue, weights, {0, 0}).empty());  // both halves have the same motion
}

TEST_CASE("seam sides: a mesh cut at a seam opens without tearing tissue") {
  const LabelVolume whole = bars(false), sided = bars(true);
  const MeshSettings settings{.spacing_mm = 9};
  const TetMesh welded = mesh_tissue(whole, settings).mesh;
  CHECK(welded.side.empty());
  const TetMesh open = mesh_tissue(sided, settings, no_progress(), {seam(whole), {0, 1}}).mesh;
  REQUIRE(std::ssize(open.side) == open.T.rows());
  CHECK(std::all_of(open.region.begin(), open.region.end(), [](auto region) { return region == TetMesh::kSoft; }));
  // Above the foot no tet has nodes on both sides, and the surfaces of the two sides do not touch.
  const double middle = kVoxel * (kWide - 0.5);
  for (Eigen::Index t = 0; t < open.T.rows(); ++t)
    for (const int node : open.T.row(t))
      if (open.V(node, 2) > kVoxel * (kFoot + 4)) CHECK((open.V(node, 0) > middle) == (open.side[t] == 1));
  CHECK(crossing_pairs(open.V, boundary_of(open)).empty());

  SolvedPose solved, torn;
  CHECK(stretch_of(open, solved) < 2);
  CHECK(solved.reached == 1);
  CHECK(solved.inverted == 0);
  CHECK(crossing_pairs(solved.V, boundary_of(open)).empty());
  CHECK(stretch_of(welded, torn) > 2.5);  // the bones tear tissue that nothing separates
}
