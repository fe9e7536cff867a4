// SPDX-License-Identifier: AGPL-3.0-or-later
#include <functional>
#include <random>

#include "core/binding/heat_diffusion.h"
#include "core/deform/preview_map.h"
#include "core/phantom/phantom.h"
#include "core/resample/resample.h"
#include "core/volume/grey_levels.h"
#include "tests/render/studio.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

const glm::ivec2 kSize(96, 80);

// Returns an image whose values change slowly, so that interpolated pictures can be compared.
GreyVolume waves(const Grid& grid) {
  GreyVolume image;
  image.grid = grid;
  const AffineTransform world = world_from_voxel(grid);
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) {
        const glm::dvec3 p = world * glm::dvec3(x, y, z);
        image.voxels.push_back(
            static_cast<float>(400 * std::sin(p.x / 9) + 300 * std::cos(p.y / 11) + 300 * std::sin(p.z / 13)));
      }
  return image;
}
double wave_at(const glm::dvec3& p) {
  return 400 * std::sin(p.x / 9) + 300 * std::cos(p.y / 11) + 300 * std::sin(p.z / 13);
}

ShownGrey shown(const GreyVolume& image) {
  return {.image = std::make_shared<const GreyLevels>(grey_levels(image.grid, image.voxels)),
          .level = 0,
          .width = 2000,
          .tissues = 0};
}

std::shared_ptr<const LabelVolume> air_on(const Grid& grid) {
  return painted(grid, [](const glm::dvec3&) -> Label { return 0; });
}

int grey_at(const Image& image, const glm::ivec2& at) { return pixel_of(image, at).r; }

// Returns an image of 64^3 voxels whose values depend on the distance from its centre, in voxels.
GreyVolume round_image(const std::function<float(double)>& value_at) {
  GreyVolume image;
  image.grid = grid_of({64, 64, 64});
  for (int i = 0; i < 64 * 64 * 64; ++i)
    image.voxels.push_back(value_at(glm::length(glm::dvec3(i % 64, i / 64 % 64, i / 4096) - 31.5)));
  return image;
}

}  // namespace

TEST_CASE("grey image: its first picture is coarse, and less coarse pictures follow while nothing moves") {
  Studio studio;
  View3D view(studio.renderer);
  Scene scene = scene_of(air_on(grid_of({64, 64, 64})));
  scene.grey = shown(round_image([](double r) { return r < 24 ? 1000.0f : 0.0f; }));
  scene.display = Display::Image;
  Camera camera = camera_of(scene.volume->grid);
  view.draw(scene, camera, kSize, 0);
  const int first = view.scale();
  CHECK(first > View3D::kCoarsest);
  // The first picture also compiles the shaders, and any picture may be held up by other programs, so this turns the
  // camera a few times. Less coarse pictures follow at once, not only after the time after which a picture is refined.
  int moved = first, still = first;
  for (int turn = 1; turn <= 50 && still >= moved; ++turn) {
    camera.distance += 1;
    view.draw(scene, camera, kSize, 0);
    moved = view.scale();
    view.draw(scene, camera, kSize, 0);
    still = view.scale();
  }
  CHECK(still < moved);
  for (double now = 1; !view.complete(); now += 1) view.draw(scene, camera, kSize, now);
  CHECK(view.scale() == 1);
}

TEST_CASE("grey image: slices show its values through the window, on another grid than that of the labels") {
  Studio studio;
  SliceView view(studio.renderer);
  Grid grid = grid_of({50, 40, 30}, {1.2, 1.5, 2});
  grid.direction[0] *= -1.0;
  grid.origin = {60, 0, 0};
  const GreyVolume image = waves(grid);
  Scene scene = scene_of(air_on(grid_of({60, 60, 60})));
  scene.grey = shown(image);
  for (const SliceAxis axis : {SliceAxis::Axial, SliceAxis::Coronal, SliceAxis::Sagittal}) {
    const SliceCamera camera{.axis = axis, .centre = {32.3, 29.2, 31.1}, .millimetres_per_pixel = 0.6};
    const SliceFrame frame = frame_of(axis);
    view.draw(scene, camera, SliceDisplay::Labels, kSize);
    const Image picture = view.read();
    const AffineTransform to_voxel = voxel_from_world(grid);
    int seen = 0;
    double worst = 0;
    for (int y = 0; y < kSize.y; ++y)
      for (int x = 0; x < kSize.x; ++x) {
        const glm::dvec2 off = (glm::dvec2(x, y) + 0.5 - glm::dvec2(kSize) / 2.0) * camera.millimetres_per_pixel;
        const glm::dvec3 world = camera.centre + frame.right * off.x + frame.down * off.y, voxel = to_voxel * world;
        if (glm::any(glm::lessThan(voxel, glm::dvec3(0))) ||
            glm::any(glm::greaterThan(voxel, glm::dvec3(grid.size) - 1.0)))
          continue;
        ++seen;
        worst = std::max(worst, std::abs(grey_at(picture, {x, y}) - 255 * (wave_at(world) / 2000 + 0.5)));
      }
    CHECK(seen > 1500);
    CHECK(worst < 4);  // of 255 grey levels; error of linear interpolation between voxels of 2 mm
  }
}

TEST_CASE("grey image: tissues lie over it with their opacity, and outlines stay solid") {
  Studio studio;
  SliceView view(studio.renderer);
  const Grid grid = grid_of({40, 40, 40});
  GreyVolume image;
  image.grid = grid;
  image.voxels.assign(64000, 500);
  const auto volume = painted(grid, [](const glm::dvec3& p) -> Label { return p.x < 20 ? 1 : 0; });
  Scene scene = scene_of(volume);
  scene.grey = shown(image);
  scene.grey->level = 500;  // this value is shown as middle grey
  const SliceCamera camera{.axis = SliceAxis::Axial, .centre = {20, 20, 20}, .millimetres_per_pixel = 0.5};
  const auto red_at = [&](float tissues, int x) {
    scene.grey->tissues = tissues;
    view.draw(scene, camera, SliceDisplay::Labels, kSize);
    return pixel_of(view.read(), {x, 40});
  };
  const int inside = 30, outside = 70;
  CHECK(std::abs(red_at(0, inside).r - 128) <= 1);
  CHECK(std::abs(red_at(0, outside).r - 128) <= 1);
  CHECK(std::abs(red_at(1, inside).r - 230) <= 1);
  CHECK(std::abs(red_at(0.5f, inside).r - 179) <= 2);
  CHECK(std::abs(red_at(0.5f, inside).b - (128 + 26) / 2) <= 2);
  CHECK(std::abs(red_at(0.5f, outside).r - 128) <= 1);
  scene.grey->tissues = 0;
  view.draw(scene, camera, SliceDisplay::Outline, kSize);
  const Image outlines = view.read();
  int solid = 0;
  for (int x = 0; x < kSize.x; ++x) solid += std::abs(pixel_of(outlines, {x, 40}).r - 230) <= 1;
  CHECK(solid >= 1);
}

TEST_CASE("grey image: large images are uploaded over several frames, and the picture says when it is complete") {
  Studio studio;
  SliceView view(studio.renderer);
  const Grid grid = grid_of({256, 256, 128});
  GreyVolume image;
  image.grid = grid;
  image.voxels.assign(static_cast<std::size_t>(grid.voxel_count()), 100);
  Scene scene = scene_of(air_on(grid));
  scene.grey = shown(image);
  const SliceCamera camera{.axis = SliceAxis::Axial, .centre = {128, 128, 127}, .millimetres_per_pixel = 2};
  int frames = 0;
  do {
    studio.renderer.begin_frame(0);
    view.draw(scene, camera, SliceDisplay::Labels, kSize);
    ++frames;
  } while (!view.complete() && frames < 1000);
  CHECK(frames > 2);
  CHECK(view.complete());
  CHECK(grey_at(view.read(), {48, 40}) == 140);
}

TEST_CASE("grey image: in 3D a ball of bone covers what a ball covers, and flesh around it is clear") {
  Studio studio;
  const Grid grid = grid_of({64, 64, 64});
  const GreyVolume image = round_image([](double r) { return r < 12 ? 900.0f : r < 28 ? 40.0f : -1000.0f; });
  Scene scene = scene_of(air_on(grid));
  scene.grey = shown(image);
  scene.display = Display::Image;
  const Camera camera = camera_of(grid, Projection::Orthographic);
  const auto share = [&](GreyRendering rendering) {
    scene.grey->rendering = rendering;
    return double(covered(picture_of(studio.renderer, scene, camera, {160, 160})));
  };
  const double bone = share(GreyRendering::Bone), skin = share(GreyRendering::Skin);
  CHECK(skin / bone == doctest::Approx(28.0 * 28 / (12 * 12)).epsilon(0.06));
  CHECK(bone > 1000);
  // The clip plane removes half of the bone from the picture.
  scene.clip.plane = {glm::dvec3(31.5), glm::dvec3(1, 0, 0)};
  CHECK(share(GreyRendering::Bone) / bone == doctest::Approx(0.5).epsilon(0.06));
}

TEST_CASE("grey image: the largest value along each line of sight is the brightest, at any step") {
  Studio studio;
  const Grid grid = grid_of({48, 48, 48});
  GreyVolume image;
  image.grid = grid;
  image.voxels.assign(48 * 48 * 48, 0);
  for (int z = 20; z < 28; ++z)
    for (int x = 20; x < 28; ++x) image.voxels[static_cast<std::size_t>(grid.index({x, 24, z}))] = 800;
  Scene scene = scene_of(air_on(grid));
  scene.grey = shown(image);
  scene.grey->level = 400;
  scene.grey->width = 1000;
  scene.grey->rendering = GreyRendering::Maximum;
  scene.display = Display::Image;
  const Image picture = picture_of(studio.renderer, scene, camera_of(grid, Projection::Orthographic), {120, 120});
  int brightest = 0;
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) brightest = std::max<int>(brightest, picture.rgba[i]);
  CHECK(brightest > 200);  // the image's value 800 is shown as 230
  CHECK(brightest <= 231);
}

TEST_CASE("grey image: a posed body carries it along, as resampling with the image does") {
  Phantom phantom = make_arm_phantom(3);
  const TissueVoxels tissue(phantom.volume);
  const SkinWeights weights = diffuse_heat(phantom.volume, phantom.tissues, phantom.armature);
  Pose pose = rest_pose(phantom.armature);
  flex(pose, phantom.armature, require_bone(phantom.armature, "Forearm"), 60);
  const GreyVolume image = waves(phantom.volume.grid);
  ResampleSettings settings;
  settings.grey = &image;
  const Posed posed =
      resample(phantom.volume, phantom.tissues, phantom.armature, weights, pose, Blend::Linear, settings);
  const auto volume = std::make_shared<const LabelVolume>(phantom.volume);
  Studio studio;
  Scene scene = scene_of(volume, std::make_shared<const LabelLooks>(looks_of(phantom.tissues)));
  scene.pose = LivePreview(volume, phantom.tissues, tissue, weights, 2)
                   .update(posed_from_rest(phantom.armature, pose), Blend::Linear);
  scene.grey = shown(image);
  SliceView view(studio.renderer);
  const AffineTransform to_voxel = voxel_from_world(posed.grey.grid);
  const glm::dvec3 middle =
      phantom.armature.bones[static_cast<std::size_t>(require_bone(phantom.armature, "Forearm"))].head;
  const SliceCamera camera{.axis = SliceAxis::Sagittal, .centre = middle, .millimetres_per_pixel = 2};
  const SliceFrame frame = frame_of(camera.axis);
  const glm::ivec2 size(200, 200);
  view.draw(scene, camera, SliceDisplay::Labels, size);
  const Image picture = view.read();
  std::vector<double> off_by;
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const glm::dvec2 off = (glm::dvec2(x, y) + 0.5 - glm::dvec2(size) / 2.0) * camera.millimetres_per_pixel;
      const glm::dvec3 world = camera.centre + frame.right * off.x + frame.down * off.y;
      const glm::ivec3 voxel(glm::floor(to_voxel * world + 0.5));
      // Voxels next to the skin or to bones are not compared, because the preview rounds their surfaces.
      bool inner = true;
      for (int k = 0; k < 27 && inner; ++k)
        inner = posed.volume.at_or_air(voxel + glm::ivec3(k % 3, k / 3 % 3, k / 9) - 1) != 0;
      if (!inner) continue;
      const float value = posed.grey.voxels[static_cast<std::size_t>(posed.grey.grid.index(voxel))];
      off_by.push_back(std::abs(grey_at(picture, {x, y}) - 255 * (double(value) / 2000 + 0.5)));
    }
  REQUIRE(off_by.size() > 1000);
  std::sort(off_by.begin(), off_by.end());
  const double usual = off_by[off_by.size() / 2], most = off_by[off_by.size() * 95 / 100];
  INFO("grey levels of 255: median " << usual << ", 95 % " << most);
  // Where the waves are steepest, the grey level changes by 12 across a voxel of 3 mm, and the pixel lies anywhere in
  // it.
  CHECK(usual < 5);
  CHECK(most < 16);
}

TEST_CASE(
    "grey image: a picture that is refined after others of the body is whole, and two images keep their textures") {
  Studio studio;
  const Grid grid = grid_of({64, 64, 64});
  const GreyVolume image = round_image([](double r) { return r < 26 ? 900.0f : -1000.0f; });
  Scene scene =
      scene_of(painted(grid, [](const glm::dvec3& p) -> Label { return glm::length(p - 31.5) < 26 ? 1 : 0; }));
  scene.grey = shown(image);
  scene.grey->rendering = GreyRendering::Skin;
  const glm::ivec2 size(160, 160);
  const Camera camera = camera_of(grid, Projection::Orthographic);
  scene.display = Display::Image;
  const Image whole = picture_of(studio.renderer, scene, camera, size);
  View3D view(studio.renderer);
  double now = 0;
  const auto refine = [&](Display display) {
    scene.display = display;
    for (int i = 0; i < 2000; ++i) {
      studio.renderer.begin_frame(1);
      view.draw(scene, camera, size, now += 0.06);
      if (i > 0 && view.complete()) return;
    }
    FAIL("never complete");
  };
  scene.display = Display::Solid;
  view.draw(scene, camera, size, now += 0.06, 4);  // draws a coarse picture of the body
  refine(Display::Image);
  CHECK(difference(view.read(), whole).share < 0.05);
  refine(Display::Solid);
  refine(Display::Image);
  CHECK(difference(view.read(), whole).share < 0.05);

  // Two views draw two images alternately, as in a comparison of two results.
  SliceView a(studio.renderer), b(studio.renderer);
  Scene other = scene;
  other.grey = shown(image);
  const SliceCamera slice{.axis = SliceAxis::Axial, .centre = {32, 32, 32}, .millimetres_per_pixel = 1};
  for (int i = 0; i < 3; ++i) {
    studio.renderer.begin_frame(0);
    a.draw(scene, slice, SliceDisplay::Labels, kSize);
    b.draw(other, slice, SliceDisplay::Labels, kSize);
  }
  CHECK(a.complete());
  CHECK(b.complete());
}
