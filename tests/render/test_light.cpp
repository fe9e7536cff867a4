// SPDX-License-Identifier: AGPL-3.0-or-later
// Pictures whose light at rest is computed by rays.
#include "core/volume_io/volume_io.h"
#include "tests/render/studio.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

// Draws until the picture is complete, 60 frames a second.
Image rested(View3D& view, const Scene& scene, const Camera& camera, const glm::ivec2& size, double& now) {
  do view.draw(scene, camera, size, now += 1.0 / 60);
  while (!view.complete());
  return view.read();
}

// The mean light of the pixels that show the body, linear.
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

// A ball that stands on a plate.
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
    // In X-ray nothing here is bone, so that all is the ghost, which has no light.
    CHECK((fine.rgba != draft.rgba) == (display != Display::XRay));
  }
}
