// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/scene/camera.h"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

using namespace limber::render;

namespace {

const glm::ivec2 kSize(800, 600);

Camera tilted(Projection projection) {
  Camera camera = orbited(looking_from(StandardView::Front, {}), {130, -75});
  camera.centre = {10, -20, 30};
  camera.projection = projection;
  return camera;
}

}  // namespace

TEST_CASE("camera: the ray through the pixel where a point appears goes through that point") {
  for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
    const Camera camera = tilted(projection);
    for (const glm::dvec3& point : {glm::dvec3(10, -20, 30), glm::dvec3(-90, 60, 110), glm::dvec3(100, 0, -80)}) {
      glm::dvec2 pixel;
      REQUIRE(project(camera, point, kSize, pixel));
      const Ray ray = ray_through(camera, pixel, kSize);
      const glm::dvec3 nearest = ray.origin + ray.direction * glm::dot(point - ray.origin, ray.direction);
      CHECK(glm::length(nearest - point) < 1e-6);
      CHECK(glm::length(ray.direction) == doctest::Approx(1));
    }
  }
}

TEST_CASE("camera: projecting agrees with the matrices, and depth lies between the planes") {
  for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
    const Camera camera = tilted(projection);
    const glm::dvec3 point(40, 10, 60);
    const glm::dvec4 clip = clip_from_view(camera, double(kSize.x) / kSize.y, camera.centre, 150) *
                            view_from_world(camera) * glm::dvec4(point, 1);
    const glm::dvec3 ndc = glm::dvec3(clip) / clip.w;
    glm::dvec2 pixel;
    REQUIRE(project(camera, point, kSize, pixel));
    CHECK(pixel.x == doctest::Approx((ndc.x * 0.5 + 0.5) * kSize.x));
    CHECK(pixel.y == doctest::Approx((0.5 - ndc.y * 0.5) * kSize.y));
    CHECK(std::abs(ndc.z) < 1);
  }
}

TEST_CASE("camera: what lies behind the eye is not projected") {
  const Camera camera = tilted(Projection::Perspective);
  glm::dvec2 pixel;
  CHECK_FALSE(project(camera, 2.0 * eye_of(camera) - camera.centre, kSize, pixel));
}

TEST_CASE("camera: the front view shows the patient's left on the right and the head on top") {
  const Camera camera = looking_from(StandardView::Front, {});
  glm::dvec2 middle, left, head;
  REQUIRE(project(camera, {0, 0, 0}, kSize, middle));
  REQUIRE(project(camera, {50, 0, 0}, kSize, left));
  REQUIRE(project(camera, {0, 0, 50}, kSize, head));
  CHECK(left.x > middle.x);
  CHECK(head.y < middle.y);
  CHECK(eye_of(camera).y < 0);
}

TEST_CASE("camera: each standard view looks at the centre from its own side") {
  const std::pair<StandardView, glm::dvec3> sides[] = {
      {StandardView::Front, {0, -1, 0}}, {StandardView::Back, {0, 1, 0}}, {StandardView::Left, {1, 0, 0}},
      {StandardView::Right, {-1, 0, 0}}, {StandardView::Top, {0, 0, 1}},  {StandardView::Bottom, {0, 0, -1}}};
  for (const auto& [side, direction] : sides) {
    const Camera camera = looking_from(side, {});
    CHECK(glm::length(eye_of(camera) - camera.centre - direction * camera.distance) < 1e-6);
  }
}

TEST_CASE("camera: framing puts every corner of the box into the picture, and not much more") {
  for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
    const glm::dvec3 low(-30, 5, -200), high(60, 80, 150);
    const Camera camera = framing(tilted(projection), low, high, double(kSize.x) / kSize.y);
    double widest = 0;
    for (int corner = 0; corner < 8; ++corner) {
      glm::dvec2 pixel;
      REQUIRE(project(camera, {corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z},
                      kSize, pixel));
      const glm::dvec2 off = glm::abs(pixel - glm::dvec2(kSize) / 2.0) / (glm::dvec2(kSize) / 2.0);
      CHECK(std::max(off.x, off.y) < 1);
      widest = std::max({widest, off.x, off.y});
    }
    CHECK(widest > 0.85);
  }
}

TEST_CASE("camera: orbiting keeps the centre and the horizon, zooming stays within its limits") {
  const Camera camera = looking_from(StandardView::Front, {});
  const Camera turned = orbited(camera, {200, 90});
  CHECK(turned.centre == camera.centre);
  CHECK(glm::length(eye_of(turned) - turned.centre) == doctest::Approx(camera.distance));
  CHECK((turned.world_from_view * glm::dvec3(1, 0, 0)).z == doctest::Approx(0).epsilon(1e-9));
  CHECK(zoomed(camera, 1e-30).distance == 1e-2);
  CHECK(zoomed(camera, 1e30).distance == 1e6);
}

TEST_CASE("camera: panning by some pixels moves the centre by as many") {
  const Camera camera = tilted(Projection::Perspective);
  const Camera moved = panned(camera, {40, -25}, kSize);
  glm::dvec2 before, after;
  REQUIRE(project(camera, camera.centre, kSize, before));
  REQUIRE(project(moved, camera.centre, kSize, after));
  CHECK(after.x - before.x == doctest::Approx(40));
  CHECK(after.y - before.y == doctest::Approx(-25));
}
