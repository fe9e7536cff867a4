// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/skinned_surface.h"

#include <doctest/doctest.h>

#include "core/base/parallel.h"

using namespace limber;

namespace {

constexpr Label kFlesh = 2, kSkin = 5;

// A ball of flesh in a shell of skin. Its upper half follows bone 1.
struct Ball {
  LabelVolume volume;
  TissueVoxels tissue;
  SkinWeights weights;
  LabelSet shown = LabelSet(65536, 0);

  // Makes the ball, 22 mm in diameter, on a grid of `edge` voxels along each axis.
  explicit Ball(int edge = 30) {
    volume.grid.size = glm::ivec3(edge);
    volume.grid.spacing = 30.0 / edge * glm::dvec3(1, 1, 1.5);
    volume.grid.origin = glm::dvec3(-15, -15, -22.5) + 0.5 * volume.grid.spacing;
    volume.voxels.assign(volume.grid.voxel_count(), 0);
    const AffineTransform world = world_from_voxel(volume.grid);
    for (int z = 0; z < edge; ++z)
      for (int y = 0; y < edge; ++y)
        for (int x = 0; x < edge; ++x)
          if (const double r = glm::length(world * glm::dvec3(x, y, z)); r < 11)
            volume.at({x, y, z}) = r < 8 ? kFlesh : kSkin;
    tissue = TissueVoxels(volume);
    weights = SkinWeights({"Lower", "Upper"}, tissue);
    for (std::int64_t b = 0; b < weights.chunk_count(); ++b)
      weights.set_chunk(b, SkinWeights::Influences(weights.chunk(b).size(), rigid_influence(1)));
    shown[kFlesh] = shown[kSkin] = 1;
  }
};

}  // namespace

TEST_CASE("skinned surface: it lies on the body, is closed, and knows the tissue that it bounds") {
  Ball ball;
  const SkinnedSurface outer = skinned_surface(ball.volume, ball.tissue, ball.weights, ball.shown, 100'000);
  REQUIRE(outer.V.size() > 500);
  for (const glm::dvec3& v : outer.V) CHECK(std::abs(glm::length(v) - 11) < 1.0);
  for (const Label label : outer.label) CHECK(label == kSkin);
  double volume = 0;  // volume of the solid that the triangles bound
  for (const glm::u32vec3& f : outer.F) volume += glm::dot(outer.V[f.x], glm::cross(outer.V[f.y], outer.V[f.z])) / 6;
  CHECK(volume == doctest::Approx(4.0 / 3 * 3.14159265 * 11 * 11 * 11).epsilon(0.06));

  ball.shown[kSkin] = 0;
  const SkinnedSurface inner = skinned_surface(ball.volume, ball.tissue, ball.weights, ball.shown, 100'000);
  for (const Label label : inner.label) CHECK(label == kFlesh);
  CHECK(inner.V.size() < outer.V.size());
  CHECK(skinned_surface(ball.volume, ball.tissue, ball.weights, ball.shown, 200).V.size() <= 200);
  ball.shown[0] = 1;  // air is never shown
  CHECK(skinned_surface(ball.volume, ball.tissue, ball.weights, ball.shown, 100'000).V == inner.V);
  ball.shown[0] = 0;
  ball.shown[kFlesh] = 0;
  CHECK(skinned_surface(ball.volume, ball.tissue, ball.weights, ball.shown, 100).V.empty());
}

TEST_CASE("skinned surface: of a volume of many voxels it lies no further off and fills the vertices it may have" *
          doctest::test_suite("slow")) {
  const Ball ball(270);
  const SkinnedSurface surface = skinned_surface(ball.volume, ball.tissue, ball.weights, ball.shown, 10'000);
  CHECK(surface.V.size() <= 10'000);
  CHECK(surface.V.size() > 4'000);
  double sum = 0;
  for (const glm::dvec3& v : surface.V) sum += glm::length(v) - 11;
  CHECK(std::abs(sum / double(surface.V.size())) < 0.5 * ball.volume.grid.spacing.x);
}

TEST_CASE("skinned surface: at rest it is where it is, a bone's motion carries all of it, and threads change nothing") {
  const Ball ball;
  const auto surface = std::make_shared<const SkinnedSurface>(
      skinned_surface(ball.volume, ball.tissue, ball.weights, ball.shown, 100'000));
  const PosedSurface rest = posed_surface(surface, {{}, {}}, Blend::DualQuaternion);
  for (std::size_t i = 0; i < rest.V.size(); ++i) CHECK(glm::distance(glm::dvec3(rest.V[i]), surface->V[i]) < 1e-5);

  const RigidTransform turn{glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, 3))), {5, -3, 2}};
  for (const Blend blend : {Blend::Linear, Blend::DualQuaternion}) {
    const PosedSurface posed = posed_surface(surface, {{}, turn}, blend);
    for (std::size_t i = 0; i < posed.V.size(); ++i) {
      CHECK(glm::distance(glm::dvec3(posed.V[i]), turn * surface->V[i]) < 1e-4);
      CHECK(glm::dot(glm::dvec3(posed.N[i]), turn.rotation * glm::normalize(surface->V[i])) > 0.7);
    }
    const ThreadCount one(1);
    const PosedSurface alone = posed_surface(surface, {{}, turn}, blend);
    CHECK(alone.V == posed.V);
    CHECK(alone.N == posed.N);
  }
}
