// SPDX-License-Identifier: AGPL-3.0-or-later
#include "tests/render/studio.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

const glm::ivec2 kSize(90, 70);

glm::ivec4 colour_of(const LabelLook& look) { return {glm::ivec3(look.colour * 255.0f + 0.5f), 255}; }

}  // namespace

TEST_CASE("slice: each pixel has the colour of the voxel under it, on every axis, mirrored grids included") {
  Studio studio;
  SliceView view(studio.renderer);
  for (const double sign : {1.0, -1.0}) {
    Grid grid = grid_of({40, 36, 44}, {1.5, 1, 2});
    grid.direction[1] *= sign;
    const auto volume = painted(grid, [](const glm::dvec3& p) -> Label {
      const auto at = static_cast<int>(std::floor(p.x / 9) + std::floor(p.y / 7) + std::floor(p.z / 13));
      return static_cast<Label>(((at % 4) + 4) % 4);
    });
    const Scene scene = scene_of(volume);
    const AffineTransform to_voxel = voxel_from_world(grid);
    for (const SliceAxis axis : {SliceAxis::Axial, SliceAxis::Coronal, SliceAxis::Sagittal}) {
      const SliceCamera camera{
          .axis = axis, .centre = world_from_voxel(grid) * glm::dvec3(20.2, 17.3, 21.1), .millimetres_per_pixel = 0.77};
      const SliceFrame frame = frame_of(axis);
      view.draw(scene, camera, SliceDisplay::Labels, kSize);
      const Image image = view.read();
      int wrong = 0, seen = 0;
      for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x) {
          const glm::dvec2 off = (glm::dvec2(x, y) + 0.5 - glm::dvec2(kSize) / 2.0) * camera.millimetres_per_pixel;
          const glm::dvec3 voxel = to_voxel * (camera.centre + frame.right * off.x + frame.down * off.y);
          const Label label = volume->at_or_air(glm::ivec3(glm::floor(voxel + 0.5)));
          if (label == 0) continue;
          ++seen;
          wrong += pixel_of(image, {x, y}) != colour_of((*scene.looks)[label]);
        }
      CHECK(seen > 1000);
      CHECK(wrong <= seen / 200);  // pixel centres exactly on a voxel's face may round to either side
    }
  }
}

TEST_CASE(
    "slice: the patient's right is on the left, the front on top in axial slices, the head on top in the others") {
  CHECK(frame_of(SliceAxis::Axial).right == glm::dvec3(1, 0, 0));
  CHECK(frame_of(SliceAxis::Axial).down == glm::dvec3(0, 1, 0));
  CHECK(frame_of(SliceAxis::Coronal).right == glm::dvec3(1, 0, 0));
  CHECK(frame_of(SliceAxis::Coronal).down == glm::dvec3(0, 0, -1));
  CHECK(frame_of(SliceAxis::Sagittal).down == glm::dvec3(0, 0, -1));
}

TEST_CASE("slice: hidden tissue shows the background, and outlines leave the inside nearly clear") {
  Studio studio;
  SliceView view(studio.renderer);
  const Grid grid = grid_of({40, 40, 40});
  const auto volume =
      painted(grid, [](const glm::dvec3& p) -> Label { return glm::length(p - glm::dvec3(20)) < 15 ? 1 : 0; });
  const SliceCamera camera{.centre = glm::dvec3(20), .millimetres_per_pixel = 0.6};
  auto looks = plain_looks();
  const auto scene_on_dark = [&] {
    Scene scene = scene_of(volume, std::make_shared<LabelLooks>(*looks));
    scene.transparent_background = false;
    return scene;
  };
  const Scene shown = scene_on_dark();
  view.draw(shown, camera, SliceDisplay::Labels, kSize);
  const glm::ivec4 filled = pixel_of(view.read(), {45, 35});
  view.draw(shown, camera, SliceDisplay::Outline, kSize);
  const Image outlines = view.read();
  (*looks)[1].visible = false;
  view.draw(scene_on_dark(), camera, SliceDisplay::Labels, kSize);
  const glm::ivec4 hidden = pixel_of(view.read(), {45, 35});
  CHECK(filled == colour_of((*plain_looks())[1]));
  CHECK(hidden.r < 70);
  CHECK(pixel_of(outlines, {45, 35}).r < 90);
  int rim = 0;
  for (int x = 0; x < kSize.x; ++x) rim += pixel_of(outlines, {x, 35}).r > 200;
  CHECK(rim >= 2);
  CHECK(rim <= 6);
}

TEST_CASE("slice: at twice the scale outlines are twice as wide") {
  Studio studio;
  SliceView view(studio.renderer);
  Scene scene = scene_of(painted(grid_of({40, 40, 40}), [](const glm::dvec3& p) -> Label {
    return glm::length(p - glm::dvec3(20)) < 15 ? 1 : 0;
  }));
  const SliceCamera camera{.centre = glm::dvec3(20), .millimetres_per_pixel = 0.6};
  // Returns how many pixels of the middle row the outline covers, at both sides of the tissue together.
  const auto covered = [&](float scale, SliceDisplay display) {
    scene.line_scale = scale;
    view.draw(scene, camera, display, kSize);
    const Image image = view.read();
    int count = 0;
    for (int x = 0; x < kSize.x; ++x) {
      const glm::ivec4 pixel = pixel_of(image, {x, 35});
      count += display == SliceDisplay::Outline ? pixel.a == 255 : pixel == glm::ivec4(255, 159, 46, 255);
    }
    return count;
  };
  for (const int scale : {1, 2, 3}) CHECK(covered(static_cast<float>(scale), SliceDisplay::Outline) == 2 * scale);
  scene.outlined = 1;
  for (const int scale : {1, 2, 3}) CHECK(covered(static_cast<float>(scale), SliceDisplay::Labels) == 2 * scale);
}

TEST_CASE("slice: without a background, air is transparent and tissue is not") {
  Studio studio;
  SliceView view(studio.renderer);
  const auto volume = painted(
      grid_of({40, 40, 40}), [](const glm::dvec3& p) -> Label { return glm::length(p - glm::dvec3(20)) < 15 ? 1 : 0; });
  const SliceCamera camera{.centre = glm::dvec3(20), .millimetres_per_pixel = 0.6};
  view.draw(scene_of(volume), camera, SliceDisplay::Labels, kSize);
  const Image image = view.read();
  CHECK(pixel_of(image, {45, 35}) == colour_of((*plain_looks())[1]));
  CHECK(pixel_of(image, {1, 1}).a == 0);
}
