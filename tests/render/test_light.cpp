// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests pictures with fine light, which rays compute while the view is at rest.
#include "core/volume_io/volume_io.h"
#include "tests/render/studio.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

// Draws at 60 frames a second until the picture is complete.
Image rested(View3D& view, const Scene& scene, const Camera& camera, const glm::ivec2& size, double& now) {
  do view.draw(scene, camera, size, now += 1.0 / 60);
  while (!view.complete());
  return view.read();
}

// Returns the mean linear brightness of the pixels that show the body.
double brightness(const Image& image) {
  double sum = 0;
  int count = 0;
  for (size_t i = 0; i < image.rgba.size(); i += 4) {
    if (image.rgba[i + 3] != 255) continue;
    for (size_t c = i; c < i + 3; ++c) sum += image.rgba[c] * image.rgba[c] / (3 * 255.0 * 255.0);
    ++count;
  }
  return sum / count;
}

// Returns a scene of a ball on a plate.
Scene ball_on_plate() {
  return scene_of(painted(grid_of({96, 96, 48}), [](const glm::dvec3& p) {
    return Label(p.z < 8.5 ? 1 : glm::length(p - glm::dvec3(47.5, 47.5, 20.5)) < 12 ? 2 : 0);
  }));
}

Camera from_above(const Scene& scene) {
  return camera_of(scene.volume->grid, Projection::Orthographic, StandardView::Top);
}

}  // namespace

TEST_CASE("fine light: a ball darkens the plate where it stands, and the open plate keeps its light") {
  Studio studio;
  const Scene scene = ball_on_plate();
  const Camera camera = from_above(scene);
  const glm::ivec2 size(192, 192);
  double now = 0;
  View3D view(studio.renderer);
  const Image draft = rested(view, scene, camera, size, now);
  studio.renderer.light_at_rest(Light::Fine);
  const Image fine = rested(view, scene, camera, size, now);
  const auto light = [](const glm::ivec4& pixel) { return pixel.r / 255.0 * pixel.r / 255.0; };
  const glm::ivec2 open(22, 22), contact(96 + 18, 96 + 22);
  CHECK(std::abs(light(pixel_of(fine, open)) / light(pixel_of(draft, open)) - 1) < 0.01);
  CHECK(light(pixel_of(fine, contact)) < 0.75 * light(pixel_of(fine, open)));
  CHECK(light(pixel_of(fine, contact)) < 0.9 * light(pixel_of(draft, contact)));
}

TEST_CASE(
    "fine light: the same scene gives the same picture, byte for byte, and another camera starts with the draft") {
  Studio studio;
  const Scene scene = ball_on_plate();
  const glm::ivec2 size(160, 160);
  const Camera camera = from_above(scene), other = looking_from(StandardView::Front, camera);
  double now = 0;
  studio.renderer.light_at_rest(Light::Fine);
  View3D view(studio.renderer), again(studio.renderer);
  const Image first = rested(view, scene, camera, size, now);
  CHECK(rested(again, scene, camera, size, now).rgba == first.rgba);

  view.draw(scene, other, size, now += 1);
  const Image moved = view.read();
  CHECK_FALSE(view.complete());
  studio.renderer.light_at_rest(Light::Draft);
  View3D plain(studio.renderer);
  plain.draw(scene, other, size, now, view.scale());
  CHECK(plain.read().rgba == moved.rgba);
  studio.renderer.light_at_rest(Light::Fine);
  rested(view, scene, other, size, now);
  CHECK(rested(view, scene, camera, size, now).rgba == first.rgba);
}

TEST_CASE("fine light: it fades in without a jump, and is as bright as the draft on the whole") {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  Studio studio;
  Scene scene;
  VolumeFile arm = read_volume(shared_path("data/bender/man-arm-2mm.mha"));
  scene.looks = std::make_shared<const LabelLooks>(looks_of(merge_tissue_tables(arm.tissues, nullptr)));
  scene.volume = std::make_shared<const LabelVolume>(std::move(arm.volume));
  scene.grid = false;
  scene.transparent_background = true;
  const glm::ivec2 size(480, 480);
  for (const StandardView side : {StandardView::Front, StandardView::Left, StandardView::Top}) {
    const Camera camera = camera_of(scene.volume->grid, Projection::Perspective, side);
    double now = 0;
    View3D view(studio.renderer);
    studio.renderer.light_at_rest(Light::Draft);
    const double draft = brightness(rested(view, scene, camera, size, now));
    studio.renderer.light_at_rest(Light::Fine);
    double before = draft, greatest = 0;
    do {
      view.draw(scene, camera, size, now += 1.0 / 60);
      const double here = brightness(view.read());
      greatest = std::max(greatest, std::abs(here - before) / draft);
      before = here;
    } while (!view.complete());
    INFO("draft ", draft, ", fine ", before, ", greatest step ", greatest);
    CHECK(std::abs(before / draft - 1) < 0.015);
    CHECK(greatest < 0.01);
  }
}

TEST_CASE("fine light: what is solid has it in every display, and the ghost of X-ray has none") {
  Studio studio;
  Scene scene = ball_on_plate();
  const glm::ivec2 size(96, 96);
  double now = 0;
  for (const Display display : {Display::Solid, Display::XRay, Display::Tissue}) {
    scene.display = display;
    View3D view(studio.renderer);
    studio.renderer.light_at_rest(Light::Draft);
    const Image draft = rested(view, scene, from_above(scene), size, now);
    studio.renderer.light_at_rest(Light::Fine);
    const Image fine = rested(view, scene, from_above(scene), size, now);
    // In X-ray every tissue here is transparent, because there is no bone. Transparent tissue gets no fine light, so
    // the two pictures must be equal.
    CHECK((fine.rgba != draft.rgba) == (display != Display::XRay));
  }
}

namespace {

// Returns the picture of a body cut by the plane y = 20.5, seen from the front, with eight pixels per voxel.
Image cut_open(Studio& studio, const std::function<Label(const glm::dvec3&)>& at) {
  Scene scene = scene_of(painted(grid_of({40, 40, 40}), at));
  scene.clip.plane = {glm::dvec3(20, 20.5, 20), glm::dvec3(0, -1, 0)};
  Camera camera = looking_from(StandardView::Front, {});
  camera.projection = Projection::Orthographic;
  camera.centre = glm::dvec3(19.5);
  camera.distance = 20 / std::tan(camera.field_of_view / 2);
  View3D view(studio.renderer);
  double now = 0;
  return rested(view, scene, camera, {320, 320}, now);
}

bool is_red(const glm::ivec4& pixel) { return pixel.r > pixel.g; }

}  // namespace

TEST_CASE("fine light: on a cut face a slanted border between tissues is straight, with a line on it, not stairs") {
  Studio studio;
  // The border is the line z = 19.5 + 0.3 (x - 19.5). In the picture, seen from this side, y goes down and x to the
  // right.
  const auto body = [](const glm::dvec3& p) -> Label {
    if (glm::any(glm::lessThan(p, glm::dvec3(3))) || glm::any(glm::greaterThan(p, glm::dvec3(36)))) return 0;
    return p.z < 19.5 + 0.3 * (p.x - 19.5) ? 1 : 2;
  };
  // Returns how much the border deviates from a straight line, pixels: the range of its distances from the true one.
  const auto roughness = [](const Image& image) {
    double lowest = 1e9, highest = -1e9;
    for (int x = 80; x < 240; ++x) {
      int y = 40;
      while (y < 280 && !is_red(pixel_of(image, {x, y}))) ++y;
      const double off = y - (160 - 0.3 * (x - 160));
      lowest = std::min(lowest, off);
      highest = std::max(highest, off);
    }
    return highest - lowest;
  };
  const Image stairs = cut_open(studio, body);
  studio.renderer.light_at_rest(Light::Fine);
  const Image smooth = cut_open(studio, body);
  INFO("the border's roughness is ", roughness(smooth), " pixels, in the draft ", roughness(stairs));
  CHECK(roughness(smooth) < 3.5);
  CHECK(roughness(smooth) < 0.6 * roughness(stairs));
  // Away from the border, a cut face has exactly the tissue's colour, which a legend shows.
  CHECK(pixel_of(smooth, {160, 250}) == glm::ivec4(230, 26, 26, 255));
  CHECK(pixel_of(smooth, {160, 70}) == glm::ivec4(26, 230, 26, 255));
  int darkest = 255;
  for (int y = 150; y < 170; ++y) {
    const glm::ivec4 pixel = pixel_of(smooth, {160, y});
    darkest = std::min(darkest, std::max(pixel.r, pixel.g));
  }
  CHECK(darkest < 150);
}

TEST_CASE("fine light: sheets and threads of one voxel do not vanish from a cut face") {
  Studio studio;
  studio.renderer.light_at_rest(Light::Fine);
  const Image image = cut_open(studio, [](const glm::dvec3& p) -> Label {
    if (glm::any(glm::lessThan(p, glm::dvec3(3))) || glm::any(glm::greaterThan(p, glm::dvec3(36)))) return 0;
    const bool sheet = std::round(p.x) == 12, thread = std::round(p.x) == 28 && std::round(p.z) == 20;
    const bool slanted = std::round(p.z) == std::round(8 + 0.4 * p.x) && p.z < 19 && p.x > 14;
    return sheet || thread || slanted ? 2 : 1;
  });
  const auto has_green = [&](const glm::ivec2& at) {
    for (int y = -6; y <= 6; ++y)
      for (int x = -6; x <= 6; ++x)
        if (!is_red(pixel_of(image, at + glm::ivec2(x, y)))) return true;
    return false;
  };
  // The centre of voxel v is at pixel 8 v + 4.
  for (int z = 6; z < 34; ++z) CHECK(has_green({8 * 12 + 4, 319 - (8 * z + 4)}));
  CHECK(has_green({8 * 28 + 4, 319 - (8 * 20 + 4)}));
  for (int x = 16; x < 26; ++x)
    CHECK(has_green({8 * x + 4, 319 - (8 * static_cast<int>(std::round(8 + 0.4 * x)) + 4)}));
  CHECK_FALSE(has_green({8 * 20 + 4, 319 - (8 * 30 + 4)}));
}

TEST_CASE("fine light: a picture is the same whatever the view showed before, up to the body's edges") {
  Studio studio;
  studio.renderer.light_at_rest(Light::Fine);
  // The cut face shows tissue 2 inside tissue 1: a close view shows only 2, and a distant one shows 1 at the edges.
  Scene scene = scene_of(painted(grid_of({40, 40, 40}), [](const glm::dvec3& p) -> Label {
    return std::abs(p.x - 19.5) < 8 && std::abs(p.z - 19.5) < 8 ? 2 : 1;
  }));
  scene.clip.plane = {glm::dvec3(20, 20.5, 20), glm::dvec3(0, -1, 0)};
  scene.line_scale = 20;
  Camera camera = looking_from(StandardView::Front, {});
  camera.projection = Projection::Orthographic;
  camera.centre = glm::dvec3(19.5);
  camera.distance = 30 / std::tan(camera.field_of_view / 2);
  const Camera near = zoomed(camera, 0.2);
  const glm::ivec2 size(160, 160);
  double now = 0;
  View3D fresh(studio.renderer), used(studio.renderer);
  const Image expected = rested(fresh, scene, camera, size, now);
  // Moves the camera until the view draws moving pictures in full resolution, so that its buffers keep their size and
  // contents.
  for (int i = 0; i < 20 && used.scale() != 1; ++i)
    used.draw(scene, zoomed(near, 1 + 0.001 * i), size, now += 1.0 / 60);
  if (used.scale() != 1) MESSAGE("too slow to move at full resolution, so that no stale pixels could be met");
  rested(used, scene, near, size, now);
  CHECK(rested(used, scene, camera, size, now).rgba == expected.rgba);
}
