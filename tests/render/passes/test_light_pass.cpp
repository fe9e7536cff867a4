// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares the light that rays find with closed-form solutions of simple scenes.
#include "render/passes/light_pass.h"

#include <numbers>

#include <epoxy/gl.h>

#include "render/passes/pass_resources.h"
#include "tests/render/studio.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

// The light that rays found at each pixel, averaged over several pictures. Rows run from the bottom up.
struct Found {
  glm::ivec2 size{0};
  std::vector<glm::vec2> light;  // fractions of the key light and of the sky that reach the pixel
  std::vector<float> depth;      // depth of the surface, mm; kNothingDepth: no hit

  // Returns the mean over a square around a pixel, without pixels of the background.
  glm::dvec2 around(const glm::dvec2& pixel, int reach) const {
    glm::dvec2 sum(0);
    int count = 0;
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x) {
        const size_t at = size_t(std::lround(pixel.x) + x) + size_t(std::lround(pixel.y) + y) * size_t(size.x);
        if (depth[at] >= kNothingDepth) continue;
        sum += glm::dvec2(light[at]);
        ++count;
      }
    REQUIRE(count > 0);
    return sum / double(count);
  }
};

Found light_of(Studio& studio, const Scene& scene, const Camera& camera, const glm::ivec2& size, int pictures) {
  PassResources& resources = studio.renderer.resources();
  auto& body = resources.body(scene.volume);
  const LooksTexture& looks = resources.looks(body, scene.looks, scene.display);
  const VisibleField& field = resources.layer(body, looks, 0);
  GBuffer buffer;
  buffer.resize(size);
  LightBuffer light;
  light.resize(buffer, 1);
  const ViewRays rays =
      view_rays(camera, body.volume->grid(), size, glm::dvec2(0), field.hull().low(), field.hull().high());
  VolumePass& pass = resources.volume_pass(*body.volume, VolumePass::Space::Rest);
  const PixelRect whole = {{0, 0}, size};
  pass.draw_hull(field.hull(), rays, buffer, whole);
  pass.march(*body.volume, field, nullptr, nullptr, looks.texture(), 0, scene.clip, rays, buffer, whole);
  Found found;
  found.size = size;
  found.light.resize(size_t(size.x) * size_t(size.y));
  found.depth.resize(found.light.size());
  glBindFramebuffer(GL_FRAMEBUFFER, buffer.march_target.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size.x, size.y, GL_RED, GL_FLOAT, found.depth.data());
  std::vector<glm::vec2> one(found.light.size());
  for (int picture = 0; picture < pictures; ++picture) {
    resources.light.draw(*body.volume, field, nullptr, nullptr, scene.clip, rays, buffer, light, picture, whole);
    glBindFramebuffer(GL_FRAMEBUFFER, light.target.name());
    glReadPixels(0, 0, size.x, size.y, GL_RG, GL_FLOAT, one.data());
    for (size_t i = 0; i < one.size(); ++i) found.light[i] += one[i] / float(pictures);
  }
  gl::check_gl("the light of a test");
  return found;
}

// Returns true if a fraction of light deviates from the expected one by at most the relative error `part`.
bool is_about(double share, double expected, double part) { return std::abs(share / expected - 1) <= part; }

// Returns an orthographic camera that looks down on a point. The picture is `width` mm wide.
Camera above(const glm::dvec3& centre, double width) {
  Camera camera;
  camera.projection = Projection::Orthographic;
  camera = looking_from(StandardView::Top, camera);
  camera.centre = centre;
  camera.distance = width / 2 / std::tan(camera.field_of_view / 2);
  return camera;
}

}  // namespace

TEST_CASE("light: in the open, on a plane at any slant and on a ball, nothing is in shadow") {
  Studio studio;
  const auto check_open = [&](const std::function<Label(const glm::dvec3&)>& at) {
    const Grid grid = grid_of({64, 64, 64});
    const Found found = light_of(studio, scene_of(painted(grid, at)), above(glm::dvec3(31.5), 40), {64, 64}, 6);
    const glm::dvec2 mean = found.around({32, 32}, 12);
    CHECK(mean.x > 0.99);
    CHECK(mean.y > 0.99);
  };
  check_open([](const glm::dvec3& p) { return Label(p.z < 30.5 ? 1 : 0); });
  check_open([](const glm::dvec3& p) { return Label(p.z < 31.5 + 0.23 * (p.x - 31.5) + 0.11 * (p.y - 31.5) ? 1 : 0); });
  check_open([](const glm::dvec3& p) { return Label(glm::length(p - glm::dvec3(31.5)) < 26 ? 1 : 0); });
}

TEST_CASE("light: in the middle of a round pit the sky has the share of its form factor") {
  // A disc of the sky of radius R, seen from a point h below its centre, has the form factor R^2 / (R^2 + h^2).
  Studio studio;
  // The smooth surface of the voxels has rounded edges, which let a little more light through.
  for (const double h : {20.0, 40.0, 80.0}) {
    constexpr double kRadius = 40;
    const glm::dvec3 middle(47.5, 47.5, 0);
    const auto pit = painted(grid_of({96, 96, 100}), [&](const glm::dvec3& p) {
      const double off = std::hypot(p.x - middle.x, p.y - middle.y);
      return Label(p.z < 10.5 || (off > kRadius && p.z < 10.5 + h) ? 1 : 0);
    });
    const Found found = light_of(studio, scene_of(pit), above({47.5, 47.5, 40}, 64), {128, 128}, 12);
    const double expected = kRadius * kRadius / (kRadius * kRadius + h * h);
    const double sky = found.around({63.5, 63.5}, 4).y;
    INFO("depth ", h, ": ", sky, ", by formula ", expected);
    CHECK(is_about(sky, expected, 0.04));
  }
}

TEST_CASE("light: inside a hollow half ball every place sees the same share of the sky") {
  // From any point inside a sphere, the form factor of a cap is the cap's fraction of the sphere's area: one half for
  // the opening of a hemisphere.
  Studio studio;
  const glm::dvec3 middle(63.5, 63.5, 70.5);
  const auto bowl = painted(grid_of({128, 128, 72}), [&](const glm::dvec3& p) {
    return Label(p.z < middle.z && glm::length(p - middle) > 54 ? 1 : 0);
  });
  const Found found = light_of(studio, scene_of(bowl), above(middle, 120), {160, 160}, 12);
  for (const double off : {0.0, 20.0, 40.0, 52.0}) {  // distance from the centre in pixels of 0.75 mm
    const double sky = found.around({79.5 + off, 79.5}, 4).y;
    INFO(off, " pixels beside the middle: ", sky);
    CHECK(is_about(sky, 0.5, 0.06));
  }
}

TEST_CASE(
    "light: a ball throws a soft shadow to the side away from the key light, and covers the sky where it stands") {
  Studio studio;
  const glm::dvec3 ball(47.5, 47.5, 22.5);
  const auto scene = scene_of(painted(grid_of({96, 96, 48}), [&](const glm::dvec3& p) {
    return Label(p.z < 10.5 || glm::length(p - ball) < 12 ? 1 : 0);
  }));
  // In the picture x points right and y points down, and the direction to the key light is (-0.428, 0.556, 0.713) with
  // y up. So the shadow is shifted to the right and down, by the ball's height times 0.428 / 0.713 and 0.556 / 0.713.
  const Found found = light_of(studio, scene, above({47.5, 47.5, 20}, 90), {180, 180}, 6);
  const double lift = ball.z - 10.5;
  const glm::dvec2 middle(89.5, 89.5), fallen = middle + 2.0 * lift * glm::dvec2(0.428, -0.556) / 0.713;
  // This point of the shadow is outside the ball's own outline.
  const glm::dvec2 shadow = fallen + glm::normalize(fallen - middle) * 10.0;
  CHECK(found.around(shadow, 1).x < 0.1);
  CHECK(found.around(middle - (shadow - middle), 1).x > 0.99);
  CHECK(found.around({20, 20}, 3).x > 0.99);
  CHECK(found.around({20, 20}, 3).y > 0.97);
  // The ball above the plane hides (r / d)^2 cos(angle to the vertical) of the sky, where d is the distance to its
  // centre.
  for (const double side : {16.0, 24.0}) {
    const double d = std::hypot(side, lift), cover = 144 / (d * d) * (lift / d);
    const double sky = found.around(middle + glm::dvec2(-2 * side, 0), 2).y;
    INFO(side, " mm beside the ball: ", sky, ", by formula ", 1 - cover);
    CHECK(is_about(sky, 1 - cover, 0.03));
  }
}

TEST_CASE("light: what a clip plane hides throws no shadow, and cut faces are open") {
  Studio studio;
  auto scene = scene_of(painted(grid_of({64, 64, 64}), [&](const glm::dvec3& p) {
    return Label(p.z < 20.5 || (p.z > 30.5 && p.z < 40.5) ? 1 : 0);
  }));
  scene.clip.plane = {glm::dvec3(32, 32, 25), glm::dvec3(0, 0, 1)};
  const Found open = light_of(studio, scene, above({31.5, 31.5, 20}, 40), {64, 64}, 4);
  CHECK(open.around({32, 32}, 8) == glm::dvec2(1));
  scene.clip.plane = {glm::dvec3(32, 32, 15), glm::dvec3(0, 0, 1)};
  const Found cut = light_of(studio, scene, above({31.5, 31.5, 20}, 40), {64, 64}, 4);
  CHECK(cut.around({32, 32}, 8) == glm::dvec2(1));
}
