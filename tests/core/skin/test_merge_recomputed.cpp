// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/skin/merge_recomputed.h"

#include <cmath>

#include <doctest/doctest.h>

#include "core/binding/geodesic.h"
#include "core/binding/heat_diffusion.h"
#include "tests/core/skin/painted.h"

using namespace limber;
using namespace limber::test;

namespace {

// Gives all voxels the same weights of trunk, left arm and right arm.
Painted even() {
  Painted painted(two_sided_body());
  painted.set([](const glm::ivec3&) { return quantize({{0, 0.5}, {1, 0.3}, {2, 0.2}}); });
  return painted;
}

SkinWeights computed_for(const Painted& painted) {
  Painted other = painted;
  other.set([](const glm::ivec3& v) {
    return v.x < 10 ? quantize({{0, 0.4}, {2, 0.6}}) : v.x > 21 ? rigid_influence(1) : rigid_influence(0);
  });
  return *other.weights;
}

}  // namespace

TEST_CASE("recomputed weights: all of them become what was computed, and nothing else changes where that is the same") {
  const Painted painted = even();
  const SkinWeights computed = computed_for(painted);
  CHECK(recomputed(painted.weighted_body(), *painted.weights, computed).weights == computed);
  const WeightEdit again = recomputed(painted.weighted_body(), computed, computed);
  CHECK(again.changed == 0);
  for (std::int64_t b = 0; b < computed.chunk_count(); ++b)
    CHECK(again.weights.shared_chunk(b) == computed.shared_chunk(b));
}

TEST_CASE("recomputed weights: one bone's alone, the others share the rest as they did") {
  const Painted painted = even();
  const SkinWeights now = recomputed(painted.weighted_body(), *painted.weights, computed_for(painted), {2}).weights;
  painted.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    const Influence& influence = at(painted.tissue, now, v);
    CHECK(std::abs(influence.of(2) - (v.x < 10 ? 0.6 : 0)) < 1e-4);
    CHECK(std::abs(influence.of(0) / influence.of(1) - 0.5 / 0.3) < 1e-3);
    CHECK(influence.weight[0] + influence.weight[1] + influence.weight[2] + influence.weight[3] == kFullWeight);
  });
  // If only the recomputed bone had weight in a voxel, what it loses there goes to the bones that have it in the
  // computed weights.
  Painted all_right = even();
  all_right.set([](const glm::ivec3&) { return rigid_influence(2); });
  const SkinWeights taken =
      recomputed(all_right.weighted_body(), *all_right.weights, computed_for(painted), {2}).weights;
  CHECK(at(painted.tissue, taken, {15, 5, 5}) == rigid_influence(0));
  CHECK(std::abs(at(painted.tissue, taken, {5, 5, 5}).of(0) - 0.4) < 1e-4);
}

TEST_CASE("recomputed weights: a locked bone keeps every bit, and so does all tissue outside the region") {
  const Painted painted = even();
  EditScope scope{.rigid_bone_tissue = false};
  scope.locked = {0, 1, 0};
  scope.region = region_where(painted.tissue, [](std::int64_t, const glm::ivec3& v) { return v.y < 6; });
  const SkinWeights now =
      recomputed(painted.weighted_body(), *painted.weights, computed_for(painted), {}, scope).weights;
  painted.tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    const Influence &before = at(painted.tissue, *painted.weights, v), &after = at(painted.tissue, now, v);
    if (v.y >= 6) CHECK(after == before);
    CHECK(after.of(1) == before.of(1));
    if (v.y < 6 && v.x < 10) CHECK(after.of(2) / after.of(0) == doctest::Approx(0.6 / 0.4).epsilon(1e-3));
  });
}

TEST_CASE(
    "blend stiffness: a stiffer tissue goes over from bone to bone in less room, others stay as they were, a softer "
    "one takes more") {
  // There is no bone in the middle, so only flesh blends there. The outer half of the bar is another tissue.
  SmallBody body = two_bone_bar(12, 60, 20);
  constexpr Label kFat = 3;
  body.tissues.tissues.push_back({.label = kFat, .file_value = kFat, .kind = TissueKind::Fat});
  for (int z = 2; z < 62; ++z)
    for (int y = 2; y < 14; ++y)
      for (int x = 2; x < 5; ++x)
        if (body.volume.at({x, y, z}) == kMuscle) body.volume.at({x, y, z}) = kFat;
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.armature);
  const auto width = [&](const SkinWeights& weights, int x) {
    int between = 0;
    for (int z = 2; z < 62; ++z) {
      const double w = at(tissue, weights, {x, 3, z}).of(1);
      between += w > 0.1 && w < 0.9;
    }
    return between;
  };
  for (const bool heat : {true, false}) {
    CAPTURE(heat);
    const auto bound = [&](const BlendStiffness& stiffness) {
      return heat ? diffuse_heat(body.volume, tissue, body.tissues, body.armature, parts, {.stiffness = stiffness})
                  : bind_geodesic(body.volume, tissue, body.armature, parts, {.stiffness = stiffness});
    };
    const SkinWeights plain = bound({}), one = bound({{kFat, 1}}), stiff = bound({{kFat, 3}}),
                      soft = bound({{kFat, 0.4}});
    CHECK(plain == one);
    CHECK(width(stiff, 2) < 0.75 * width(plain, 2));
    CHECK(width(soft, 2) > width(plain, 2));
    CHECK(std::abs(width(stiff, 13) - width(plain, 13)) <= (heat ? 3 : 0));
  }
}
