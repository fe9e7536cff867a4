// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>

#include <doctest/doctest.h>

#include "tests/core/skin/painted.h"

using namespace limber;
using namespace limber::test;

namespace {

// A bar with two bones whose weights change linearly along it.
Painted slope() {
  Painted painted(two_bone_bar(12, 40, 6));
  painted.set([](const glm::ivec3& v) {
    const double share = v.z / 40.0;
    return quantize({{0, 1 - share}, {1, share}});
  });
  return painted;
}

StrokeSettings cloning(const glm::dvec3& reference) {
  StrokeSettings settings;
  settings.brush = {.kind = find_brush("clone")->kind, .radius = 9, .falloff = FalloffShape::Constant};
  settings.brush.reference = reference;
  settings.bones = {1};
  return settings;
}

double share_of_one(const Painted& painted, const SkinWeights& weights, const glm::ivec3& v) {
  return at(painted.tissue, weights, v).of(1);
}

}  // namespace

TEST_CASE("clone brush: weights come from as far away as the cross-hair was from where the stroke began") {
  const Painted painted = slope();
  const AffineTransform world = world_from_voxel(painted.body.volume.grid);
  const glm::ivec3 from(2, 2, 10), to(2, 2, 24);
  Stroke stroke(painted.weighted_body(), painted.weights, cloning(world * glm::dvec3(from)));
  stroke.to(world * glm::dvec3(to));
  stroke.to(world * (glm::dvec3(to) + glm::dvec3(0, 0, 6)));
  const SkinWeights after = stroke.finish();
  for (const int step : {-2, 0, 3, 6})
    CHECK(share_of_one(painted, after, to + glm::ivec3(0, 0, step)) ==
          doctest::Approx((from.z + step) / 40.0).epsilon(1e-3));
  // Voxels beyond the brush keep their weights.
  CHECK(share_of_one(painted, after, {2, 2, 12}) == share_of_one(painted, *painted.weights, {2, 2, 12}));
}

TEST_CASE("clone brush: nothing is copied from air, and a stroke over itself copies what was there before") {
  const Painted painted = slope();
  const AffineTransform world = world_from_voxel(painted.body.volume.grid);
  const auto copied = [&](const glm::dvec3& reference) {
    Stroke stroke(painted.weighted_body(), painted.weights, cloning(reference));
    stroke.to(world * glm::dvec3(2, 2, 20));
    stroke.to(world * glm::dvec3(2, 2, 28));
    return stroke.finish();
  };
  const SkinWeights none = copied(world * glm::dvec3(200, 2, 20));
  CHECK(share_of_one(painted, none, {2, 2, 20}) == share_of_one(painted, *painted.weights, {2, 2, 20}));
  // Copies from two voxels further down. The stroke reads the weights before the stroke, not those that it has just
  // painted.
  const SkinWeights shifted = copied(world * glm::dvec3(2, 2, 18));
  CHECK(share_of_one(painted, shifted, {2, 2, 26}) == doctest::Approx(24 / 40.0).epsilon(1e-3));
}
