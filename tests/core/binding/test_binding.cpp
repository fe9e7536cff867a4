// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests what geodesic, rigid and heat weights have in common, and how they differ.
#include <cmath>

#include <doctest/doctest.h>

#include "core/binding/geodesic.h"
#include "core/binding/heat_diffusion.h"
#include "core/binding/rigid.h"
#include "tests/core/skin/small_body.h"

using namespace limber;
using namespace limber::test;

namespace {
Influence at(const SkinWeights& weights, const TissueVoxels& tissue, const glm::ivec3& v) {
  const int brick = tissue.brick_at(v);
  return weights.chunk(brick)[tissue.index_of(v) - tissue.bricks()[brick].first];
}

// A hand of two fingers, one voxel of air between them, joined at the palm: bone 0 runs through the palm (low z), 1 and
// 2 through the fingers.
SmallBody two_fingers() {
  SmallBody body;
  body.tissues = muscle_and_bone();
  body.volume.grid.size = {21, 11, 44};
  body.volume.grid.spacing = glm::dvec3(2);
  body.volume.voxels.assign(body.volume.grid.voxel_count(), 0);
  for (int z = 2; z < 42; ++z)
    for (int y = 1; y < 10; ++y)
      for (int x = 1; x < 20; ++x) {
        const bool palm = z < 14, finger = x != 10;
        if (!palm && !finger) continue;
        const int across = palm ? std::abs(x - 10) : std::abs(x < 10 ? x - 5 : x - 15);
        const bool bone = across <= 1 && std::abs(y - 5) <= 1 && (palm ? z < 12 : z > 15);
        body.volume.at({x, y, z}) = bone ? kBone : kMuscle;
      }
  body.armature.bones = {bone_between("Palm", -1, {20, 10, 4}, {20, 10, 26}),
                         bone_between("Left", 0, {10, 10, 30}, {10, 10, 84}),
                         bone_between("Right", 0, {30, 10, 30}, {30, 10, 84})};
  return body;
}

struct Bound {
  SmallBody body;
  TissueVoxels tissue;
  BoneParts parts;
  SkinWeights heat, geodesic, rigid;
  explicit Bound(SmallBody made)
      : body(std::move(made)),
        tissue(body.volume),
        parts(split_bones(body.volume, tissue, body.tissues, body.armature)),
        heat(diffuse_heat(body.volume, tissue, body.tissues, body.armature, parts)),
        geodesic(bind_geodesic(body.volume, tissue, body.armature, parts)),
        rigid(bind_rigid(body.volume, tissue, body.armature, parts)) {}
};
}  // namespace

TEST_CASE("binding: every method covers every voxel, sums to exactly one, and holds bone on its bone") {
  const Bound bound(two_fingers());
  for (const SkinWeights* weights : {&bound.heat, &bound.geodesic, &bound.rigid}) {
    CHECK(weights->size() == bound.tissue.size());
    bound.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
      const Influence influence = at(*weights, bound.tissue, v);
      int sum = 0;
      for (int k = 0; k < 4; ++k) sum += influence.weight[k];
      CHECK(sum == kFullWeight);
      if (const int part = bound.parts.part_of[place])
        CHECK(influence == rigid_influence(bound.parts.parts[part - 1].bone));
    });
  }
}

TEST_CASE("binding: no method leaks from finger to finger through the air between them") {
  const Bound bound(two_fingers());
  // At the tips, the path through the palm is ten times as long as the gap is wide. If heat crossed the gap, the
  // weights would be near a half.
  for (int z = 32; z < 42; ++z)
    for (int y = 1; y < 10; ++y) {
      CHECK(at(bound.heat, bound.tissue, {9, y, z}).of(2) < 0.002);
      CHECK(at(bound.heat, bound.tissue, {11, y, z}).of(1) < 0.002);
      CHECK(at(bound.geodesic, bound.tissue, {9, y, z}).of(2) < 0.04);
      CHECK(at(bound.geodesic, bound.tissue, {11, y, z}).of(1) < 0.04);
      CHECK(at(bound.rigid, bound.tissue, {9, y, z}) == rigid_influence(1));
      CHECK(at(bound.rigid, bound.tissue, {11, y, z}) == rigid_influence(2));
    }
}

TEST_CASE("binding: rigid weights are one bone a voxel, in a bar the one whose voxels are nearer") {
  const Bound bound(two_bone_bar());
  bound.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    const Influence influence = at(bound.rigid, bound.tissue, v);
    CHECK(influence.weight[0] == kFullWeight);
    if (v.z != 21 && v.z != 22) CHECK(influence.bone[0] == (v.z < 22 ? 0 : 1));
  });
}

TEST_CASE("binding: geodesic weights follow the law of their paper") {
  const Bound bound(two_bone_bar());
  // On the axis between the two bones the paths are straight, so the test computes their lengths by counting voxels.
  for (int z = 19; z < 25; ++z) {
    const double a = 2 * (z - 18) / 100.0, b = 2 * (25 - z) / 100.0;
    auto strength = [](double d) { return std::pow(1 / (0.5 * d + 0.5 * d * d), 2); };
    CHECK(at(bound.geodesic, bound.tissue, {7, 7, z}).of(0) ==
          doctest::Approx(strength(a) / (strength(a) + strength(b))).epsilon(0.01));
  }
}
