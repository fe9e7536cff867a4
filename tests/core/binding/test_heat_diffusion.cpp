// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/heat_diffusion.h"

#include <cmath>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/binding/geodesic.h"
#include "core/binding/rigid.h"
#include "tests/core/skin/small_body.h"

using namespace limber;
using namespace limber::test;

namespace {
Influence at(const SkinWeights& weights, const TissueVoxels& tissue, const glm::ivec3& v) {
  const int brick = tissue.brick_at(v);
  return weights.chunk(brick)[tissue.index_of(v) - tissue.bricks()[brick].first];
}
double largest_difference(const SkinWeights& a, const SkinWeights& b) {
  double largest = 0;
  for (std::int64_t c = 0; c < a.chunk_count(); ++c)
    for (size_t i = 0; i < a.chunk(c).size(); ++i)
      for (int bone = 0; bone < std::ssize(a.bones()); ++bone)
        largest = std::max(largest, std::abs(a.chunk(c)[i].of(bone) - b.chunk(c)[i].of(bone)));
  return largest;
}
}  // namespace

TEST_CASE("heat: bone is exactly rigid, the middle of the joint is shared, weights fall along the limb") {
  const SmallBody body = two_bone_bar();
  const TissueVoxels tissue(body.volume);
  WeightsReport report;
  const SkinWeights weights = diffuse_heat(body.volume, body.tissues, body.armature, {}, no_progress(), &report);
  CHECK(report.residual <= 1e-5);
  CHECK(report.warnings.empty());
  tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    if (body.volume.at(v) == kBone) CHECK(at(weights, tissue, v) == rigid_influence(v.z < 22 ? 0 : 1));
  });
  double before = 1;
  for (int z = 2; z < 42; ++z) {
    const double upper = at(weights, tissue, {2, 2, z}).of(0);
    CHECK(upper <= before + 1e-4);
    CHECK(upper + at(weights, tissue, {2, 2, 43 - z}).of(0) == doctest::Approx(1).epsilon(0.03));
    before = upper;
  }
}

TEST_CASE("heat: through a slab between two bones the weight rises evenly and alike from both sides") {
  // Two plates of bone with 9 voxels of muscle between them.
  SmallBody body = two_bone_bar(6, 24, 9);
  body.volume.grid.size = {6, 6, 24};
  body.volume.voxels.assign(body.volume.grid.voxel_count(), kBone);
  for (int z = 8; z < 17; ++z)
    for (int y = 0; y < 6; ++y)
      for (int x = 0; x < 6; ++x) body.volume.at({x, y, z}) = kMuscle;
  body.armature.bones[0] = bone_between("Upper", -1, {5, 5, 0}, {5, 5, 16});
  body.armature.bones[1] = bone_between("Lower", 0, {5, 5, 32}, {5, 5, 80});
  const TissueVoxels tissue(body.volume);
  const SkinWeights weights = diffuse_heat(body.volume, body.tissues, body.armature, {.residual = 1e-6});
  double before = 0;
  for (int z = 8; z < 17; ++z) {
    const double lower = at(weights, tissue, {3, 2, z}).of(1);
    CHECK(lower > before);
    CHECK(lower == doctest::Approx(at(weights, tissue, {0, 5, z}).of(1)).epsilon(1e-3));
    if (z != 12) CHECK(lower + at(weights, tissue, {3, 2, 24 - z}).of(1) == doctest::Approx(1).epsilon(0.2));
    before = lower;
  }
}

TEST_CASE("heat: weights do not depend on when the iteration stops") {
  const SmallBody body = two_bone_bar(18, 60, 10);
  const SkinWeights usual = diffuse_heat(body.volume, body.tissues, body.armature, {.residual = 1e-5});
  const SkinWeights tighter = diffuse_heat(body.volume, body.tissues, body.armature, {.residual = 1e-6});
  CHECK(largest_difference(usual, tighter) < 1e-3);
}

TEST_CASE("heat: 1, 2 and 4 threads give the same weights") {
  const SmallBody body = two_bone_bar(24, 60, 8);
  std::vector<SkinWeights> results;
  for (int threads : {1, 2, 4}) {
    const ThreadCount limit(threads);
    results.push_back(diffuse_heat(body.volume, body.tissues, body.armature));
  }
  CHECK(results[0] == results[1]);
  CHECK(results[0] == results[2]);
}

TEST_CASE("heat: nothing flows through air, and an island in the air is named") {
  // Adds a second bar of muscle one voxel beside the first, with no connection to it.
  SmallBody body = two_bone_bar(6, 24, 4);
  const glm::ivec3 size = body.volume.grid.size;
  LabelVolume wide = body.volume;
  wide.grid.size.x = 2 * size.x;
  wide.voxels.assign(wide.grid.voxel_count(), 0);
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        wide.at({x, y, z}) = body.volume.at({x, y, z});
        if (x < 5 && z > 14 && y > 3 && y < 7 && z < 20) wide.at({x + 10, y, z}) = kMuscle;
      }
  WeightsReport report;
  const TissueVoxels tissue(wide);
  const SkinWeights weights = diffuse_heat(wide, body.tissues, body.armature, {}, no_progress(), &report);
  REQUIRE(report.warnings.size() == 1);
  CHECK(report.warnings[0].find("75 voxels of label 1") != std::string::npos);
  CHECK(report.warnings[0].find("assigned to Lower") != std::string::npos);
  CHECK(at(weights, tissue, {11, 5, 15}) == rigid_influence(1));

  // The warning uses the tissue's name if the table has one, and writes "1 voxel" in the singular.
  for (Tissue& one : body.tissues.tissues)
    if (one.label == kMuscle) one.name = "calf muscle";
  wide.at({14, 1, 1}) = kMuscle;
  WeightsReport named;
  diffuse_heat(wide, body.tissues, body.armature, {}, no_progress(), &named);
  REQUIRE(named.warnings.size() == 2);
  CHECK(named.warnings[0].starts_with("no bone reaches 75 voxels of calf muscle near ("));
  CHECK(named.warnings[1].starts_with("no bone reaches 1 voxel of calf muscle near ("));

  // Rigid and geodesic weights give the same warnings.
  const TissueVoxels both(wide);
  const BoneParts parts = split_bones(wide, both, body.tissues, body.armature);
  WeightsReport rigid, geodesic;
  bind_rigid(wide, both, body.armature, parts, no_progress(), &rigid, &body.tissues);
  bind_geodesic(wide, both, body.armature, parts, {}, no_progress(), &geodesic, &body.tissues);
  CHECK(rigid.warnings == named.warnings);
  CHECK(geodesic.warnings == named.warnings);
}

TEST_CASE("heat: without bone tissue the voxels along each rig bone are the sources") {
  SmallBody body = two_bone_bar();
  for (Label& label : body.volume.voxels)
    if (label == kBone) label = kMuscle;
  const TissueVoxels tissue(body.volume);
  const SkinWeights weights = diffuse_heat(body.volume, body.tissues, body.armature);
  CHECK(at(weights, tissue, {7, 7, 5}) == rigid_influence(0));
  CHECK(at(weights, tissue, {8, 8, 38}) == rigid_influence(1));
  CHECK(at(weights, tissue, {2, 2, 5}).of(0) > 0.95);
  CHECK(at(weights, tissue, {2, 2, 38}).of(1) > 0.95);
}

TEST_CASE("heat: spacing counts: a limb of flat voxels gets the weights of the same limb of cubes") {
  const SmallBody cubes = two_bone_bar(12, 48, 8, glm::dvec3(2)), flat = two_bone_bar(12, 24, 4, {2, 2, 4});
  const TissueVoxels of_cubes(cubes.volume), of_flat(flat.volume);
  const SkinWeights a = diffuse_heat(cubes.volume, cubes.tissues, cubes.armature),
                    b = diffuse_heat(flat.volume, flat.tissues, flat.armature);
  for (int z = 0; z < 24; ++z) {
    const double two = (at(a, of_cubes, {2, 7, 2 + 2 * z}).of(0) + at(a, of_cubes, {2, 7, 3 + 2 * z}).of(0)) / 2;
    CHECK(std::abs(two - at(b, of_flat, {2, 7, 2 + z}).of(0)) < 0.02);
  }
}
