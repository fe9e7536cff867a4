// SPDX-License-Identifier: AGPL-3.0-or-later
// Two bars touch along a seam and are one at their foot, as two thighs are. One bar bends away from the other.
#include "core/fem/seam_sides.h"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>
#include <glm/gtc/constants.hpp>

#include "core/fem/solve_pose.h"
#include "core/fem/tissue_model.h"
#include "core/mesh/crossings.h"
#include "core/mesh/mesh_tissue.h"
#include "core/mesh/split_at_seams.h"
#include "tests/support/bent_tube.h"

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

const LabelSet kNoBone(65536, 0);

// Position of the joint between the bones of the two bars: in the middle of their common foot, mm.
const glm::dvec3 kJoint(kVoxel*(kWide - 0.5), 0.5 * kVoxel * kDeep, 0.5 * kVoxel * kFoot);

// Returns the rig of the two bars.
Armature rig() { return {{{"left", -1, {0, 0, 0}, {0, 0, 9}}, {"right", 0, kJoint, {60, 0, 90}}}}; }

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

// Returns the sides of the two bars with the given seams.
SeamSides cut_at(std::shared_ptr<const Seams> seams) { return {{0, 1}, std::move(seams)}; }

// Returns true if tets of both sides share a node.
bool has_tet_across(const TetMesh& mesh) {
  std::vector<int> side(mesh.V.rows(), -1);
  for (Eigen::Index t = 0; t < mesh.T.rows(); ++t)
    for (const int node : mesh.T.row(t)) {
      if (side[node] >= 0 && side[node] != mesh.side[t]) return true;
      side[node] = mesh.side[t];
    }
  return false;
}

}  // namespace

TEST_CASE("seam sides: the bones on both sides of a seam differ") {
  const LabelVolume volume = bars(false);
  TissueVoxels tissue(volume);
  const SkinWeights weights = halves(tissue);
  const auto sides = [&](const std::vector<int>& moves_as) {
    return sides_of_seams(volume, tissue, kNoBone, weights, rig(), moves_as);
  };
  CHECK(sides({0, 1}).sides.of_bone.empty());
  tissue.set_seams(seam(volume));
  const VoxelSides found = sides({0, 1});
  CHECK(found.sides.of_bone == std::vector<std::uint16_t>{0, 1});
  REQUIRE(std::ssize(found.of_voxel) == tissue.size());
  CHECK(found.strays.empty());
  CHECK(*found.sides.seams == *seam(volume));  // the foot, where the joint is, stays one
  CHECK(!sides({0, 0}).sides.seams);           // both halves have the same motion
}

TEST_CASE("seam sides: gaps of a seam are closed, except around the joint that attaches the sides") {
  const LabelVolume volume = bars(false);
  auto with_gaps = std::make_shared<Seams>(*seam(volume));
  for (int z = 22; z < 31; ++z)
    for (int y = 2; y < 10; ++y) with_gaps->join({kWide - 1, y, z}, 0);
  TissueVoxels tissue(volume);
  tissue.set_seams(with_gaps);
  CHECK(*sides_of_seams(volume, tissue, kNoBone, halves(tissue), rig(), {0, 1}).sides.seams == *seam(volume));
}

TEST_CASE("seam sides: an island without bone follows the bone around it, one with bone does not") {
  const LabelVolume volume = bars(false);
  TissueVoxels tissue(volume);
  tissue.set_seams(seam(volume));
  const glm::ivec3 island(3, 5, 30);  // two voxels of the left bar that follow the right bone
  SkinWeights weights = halves(tissue);
  std::vector<std::int64_t> places;
  for (const glm::ivec3& v : {island, island + glm::ivec3(0, 0, 1)}) {
    const int brick = tissue.brick_at(v);
    SkinWeights::Influences chunk = weights.chunk(brick);
    places.push_back(tissue.index_of(v));
    chunk[places.back() - tissue.bricks()[brick].first] = rigid_influence(1);
    weights.set_chunk(brick, std::move(chunk));
  }
  const auto sides_with = [&](bool is_bone) {
    LabelVolume labels = volume;
    if (is_bone) labels.at(island) = 2;
    LabelSet bones = kNoBone;
    bones[2] = 1;
    return sides_of_seams(labels, tissue, bones, weights, rig(), {0, 1});
  };
  const VoxelSides soft = sides_with(false), bony = sides_with(true);
  CHECK(soft.of_voxel[places[0]] == 0);
  CHECK(soft.strays.size() == 2);
  CHECK(bony.of_voxel[places[0]] == 1);
  CHECK(bony.strays.empty());
  const SkinWeights joined = without_strays(weights, tissue, soft.strays);
  for (std::int64_t brick = 0; brick < joined.chunk_count(); ++brick) {
    auto influence = joined.chunk(brick).begin();
    bool same = true;
    tissue.for_each(brick, brick + 1,
                    [&](std::int64_t, const glm::ivec3& v) { same &= *influence++ == rigid_influence(v.x >= kWide); });
    CHECK(same);
  }
}

TEST_CASE("seam sides: a mesh cut at a seam opens without tearing tissue") {
  const LabelVolume whole = bars(false), sided = bars(true);
  const MeshSettings settings{.spacing_mm = 9};
  const TetMesh welded = mesh_tissue(whole, settings).mesh;
  CHECK(welded.side.empty());
  const TetMesh open = mesh_tissue(sided, settings, no_progress(), cut_at(seam(whole))).mesh;
  REQUIRE(std::ssize(open.side) == open.T.rows());
  CHECK(std::all_of(open.region.begin(), open.region.end(), [](auto region) { return region == TetMesh::kSoft; }));
  CHECK(has_tet_across(open));  // in the foot the sides are one
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

TEST_CASE("seam sides: sides that only a node connects are split there, and moved apart") {
  TetMesh mesh;
  mesh.V.resize(7, 3);
  mesh.V << 0, 0, 0, 9, 0, 0, 0, 9, 0, 0, 0, 9, -9, 0, 0, 0, -9, 0, 0, 0, -9;
  mesh.T.resize(2, 4);
  mesh.T << 0, 1, 2, 3, 0, 5, 4, 6;  // two tets that share node 0
  for (const auto& tet : mesh.T.rowwise()) REQUIRE(signed_volume(mesh.V, tet) > 0);
  mesh.region = {TetMesh::kSoft, soft_region(1)};
  const Eigen::MatrixX4i before = mesh.T;
  CHECK(split_at_faces(mesh, {}).empty());
  CHECK(split_at_faces(mesh, {}, {0}) == std::vector<int>{0});
  CHECK(mesh.T(1, 0) == 7);
  open_faces(mesh, {}, before, 0.5);
  CHECK(mesh.V.row(0).minCoeff() > 0.1);   // into the tet that keeps the node
  CHECK(mesh.V.row(7).maxCoeff() < -0.1);  // into the other tet
}

TEST_CASE("seam sides: a seam with teeth becomes smooth in the mesh, so that its sides can slide") {
  // The seam jumps by 4 voxels every 4 voxels along z.
  LabelVolume sided = bars(false);
  auto teeth = std::make_shared<Seams>(sided.grid.size);
  const auto border = [](int z) { return kWide + (z / 4 % 2 ? 2 : -2); };
  glm::ivec3 v;
  for (v.z = 0; v.z < kLong; ++v.z)
    for (v.y = 0; v.y < kDeep; ++v.y)
      for (v.x = 0; v.x < 2 * kWide; ++v.x) {
        if (v.x >= border(v.z)) sided.at(v) = static_cast<Label>(1 + soft_region(1));
        if (v.x == border(v.z) - 1) teeth->cut(v, 0);
        if (v.z + 1 < kLong && (v.x >= border(v.z)) != (v.x >= border(v.z + 1))) teeth->cut(v, 2);
      }
  const TetMesh mesh = mesh_tissue(sided, {.spacing_mm = 6}, no_progress(), cut_at(teeth)).mesh;
  double furthest = 0;  // distance of nodes at the seam, away from the skin, from the seam's middle plane, mm
  const double middle = kVoxel * (kWide - 0.5);
  const Eigen::MatrixX3i surface = boundary_of(mesh);
  for (const int node : surface.reshaped()) {
    const auto at = mesh.V.row(node);
    const bool is_inside = at[1] > 9 && at[1] < kVoxel * kDeep - 12 && at[2] > 15 && at[2] < kVoxel * kLong - 18;
    if (is_inside && std::abs(at[0] - middle) < 12) furthest = std::max(furthest, std::abs(at[0] - middle));
  }
  CHECK(furthest > 0);
  CHECK(furthest < 4);  // the teeth reach out by 6 mm
}

TEST_CASE("seam sides: nodes are free where only the mesh brings two rigid sides together") {
  // The bars are 2 voxels of air apart, less than an edge of a coarse tet. The pose itself deforms nothing.
  LabelVolume volume = bars(false), sided = bars(true);
  glm::ivec3 v;
  for (v.z = 0; v.z < kLong; ++v.z)
    for (v.y = 0; v.y < kDeep; ++v.y)
      for (v.x = kWide - 1; v.x <= kWide; ++v.x) volume.at(v) = sided.at(v) = 0;
  const TissueVoxels tissue(volume);
  VoxelSides sides;
  sides.sides = cut_at(std::make_shared<Seams>(volume.grid.size));
  tissue.for_each([&](std::int64_t, const glm::ivec3& at) { sides.of_voxel.push_back(at.x >= kWide); });
  DeformingRegion moving;
  moving.moves_as = {0, 1};
  for (const TissueVoxels::Brick& brick : tissue.bricks()) {
    moving.meshed.push_back(brick.mask);
    moving.free.push_back({});
    moving.free_from.emplace_back().fill(INFINITY);
  }
  const auto model = [&](double spacing_mm) {
    return tissue_model(volume, tissue, test::tube_tissues(), halves(tissue), moving,
                        mesh_tissue(sided, {.spacing_mm = spacing_mm}, no_progress(), sides.sides).mesh,
                        {.sides = &sides});
  };
  const TissueModel coarse = model(7);
  const FemModel& fem = coarse.fem;
  std::int64_t free = 0, held = 0;
  const double middle = kVoxel * (kWide - 0.5);
  for (Eigen::Index i = 0; i < fem.mesh.V.rows(); ++i) {
    const double off = std::abs(fem.mesh.V(i, 0) - middle);
    (fem.held_by[i] < 0 ? free : held) += 1;
    if (off < 4) CHECK(fem.held_by[i] < 0);
  }
  CHECK(free > 0);
  CHECK(held > 0);
  CHECK(fem.mesh.side.size() > 0);
  for (const int holder : model(3).fem.held_by) CHECK(holder >= 0);  // a fine mesh keeps the air

  // Where all nodes of a bar are near the other side, the bar would lie loose: a bone holds it.
  for (const int holder : model(16).fem.held_by) CHECK(holder >= 0);
}
