// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests volumes whose labels change while they are on the graphics card. Only blocks near the change may be uploaded,
// and pictures must equal those of the changed volume uploaded as a new volume.
#include "render/passes/pass_resources.h"
#include "tests/render/studio.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

using Surface = PassResources::Surface;

constexpr glm::ivec2 kSize{240, 200};

const Grid kGrid = grid_of({90, 80, 70}, {1, 1.5, 1});

// Returns a ball (label 1) with a core (label 3) in the middle of a box that is mostly air.
std::shared_ptr<LabelVolume> ball() {
  return std::make_shared<LabelVolume>(*painted(kGrid, [](const glm::dvec3& p) {
    const double r = glm::distance(p, glm::dvec3(38, 60, 35));
    return Label(r < 9 ? 3 : r < 18 ? 1 : 0);
  }));
}

// Gives `label` to a ball of voxels, and returns the box of voxels that may have changed.
VoxelBox paint(LabelVolume& volume, const glm::dvec3& centre, double radius, Label label) {
  const AffineTransform world = world_from_voxel(volume.grid), voxel = voxel_from_world(volume.grid);
  const glm::dvec3 reach = radius / volume.grid.spacing;
  const glm::ivec3 low = glm::max(glm::ivec3(glm::floor(voxel * centre - reach)), glm::ivec3(0)),
                   high = glm::min(glm::ivec3(glm::ceil(voxel * centre + reach)), volume.grid.size - 1);
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y)
      for (int x = low.x; x <= high.x; ++x)
        if (glm::distance(world * glm::dvec3(x, y, z), centre) <= radius) volume.at({x, y, z}) = label;
  return {low, high - low + 1};
}

Image slice_of(Renderer& renderer, const std::shared_ptr<const LabelVolume>& volume, const glm::dvec3& at) {
  SliceView view(renderer);
  SliceCamera camera;
  camera.centre = at;
  camera.millimetres_per_pixel = 0.7;
  view.draw(scene_of(volume), camera, SliceDisplay::Labels, kSize);
  return view.read();
}
Image body_of(Renderer& renderer, const std::shared_ptr<const LabelVolume>& volume, Display display = Display::Solid) {
  View3D view(renderer);
  Scene scene = scene_of(volume);
  scene.display = display;
  view.draw(scene, camera_of(kGrid), kSize, 0, 1);
  return view.read();
}

// Returns a copy, which the renderer must upload as a new volume.
std::shared_ptr<const LabelVolume> anew(const LabelVolume& volume) {
  return std::make_shared<const LabelVolume>(volume);
}

}  // namespace

TEST_CASE("relabel: labels painted in place are shown as if the volume were uploaded anew, in slices and in 3D") {
  Studio studio;
  PassResources& resources = studio.renderer.resources();
  const auto volume = ball();
  const glm::dvec3 middle(38, 60, 35);
  body_of(studio.renderer, volume);
  body_of(studio.renderer, volume, Display::XRay);
  // The dabs are: over tissue, at the surface, erasing to air (twice), and far out in air where no slot exists yet.
  const std::vector<std::pair<glm::dvec3, Label>> dabs = {
      {{38, 50, 38}, 2}, {{54, 60, 35}, 1}, {{38, 43, 35}, 0}, {{38, 60, 35}, 0}, {{80, 108, 60}, 2}};
  for (const auto& [centre, label] : dabs) {
    const VoxelBox box = paint(*volume, centre, 7, label);
    const int revision = resources.revision_of(volume), uploads = resources.uploads();
    resources.relabel(volume, volume, box, Surface::AtOnce);
    // A change within the body's blocks needs no new slots, so the textures are kept.
    if (centre.x == middle.x) CHECK(resources.uploads() == uploads);
    CHECK(resources.revision_of(volume) != revision);
    const auto fresh = anew(*volume);
    CHECK(slice_of(studio.renderer, volume, middle).rgba == slice_of(studio.renderer, fresh, middle).rgba);
    CHECK(slice_of(studio.renderer, volume, centre).rgba == slice_of(studio.renderer, fresh, centre).rgba);
    CHECK(body_of(studio.renderer, volume).rgba == body_of(studio.renderer, fresh).rgba);
    CHECK(body_of(studio.renderer, volume, Display::XRay).rgba == body_of(studio.renderer, fresh, Display::XRay).rgba);
  }
}

TEST_CASE("relabel: while the surface waits slices are up to date, and it follows with the last change") {
  Studio studio;
  PassResources& resources = studio.renderer.resources();
  const auto volume = ball();
  const glm::dvec3 at(38, 43, 35);
  const Image before = body_of(studio.renderer, volume);
  resources.relabel(volume, volume, paint(*volume, at, 8, 0), Surface::Waits);
  const auto fresh = anew(*volume);
  CHECK(slice_of(studio.renderer, volume, at).rgba == slice_of(studio.renderer, fresh, at).rgba);
  CHECK(body_of(studio.renderer, volume).rgba != body_of(studio.renderer, fresh).rgba);
  resources.relabel(volume, volume, {}, Surface::AtOnce);
  CHECK(body_of(studio.renderer, volume).rgba == body_of(studio.renderer, fresh).rgba);
  CHECK(body_of(studio.renderer, volume).rgba != before.rgba);
}

TEST_CASE("relabel: another volume takes the textures over, and a view that draws it follows the change") {
  Studio studio;
  PassResources& resources = studio.renderer.resources();
  const std::shared_ptr<const LabelVolume> before = ball();
  const auto painted_ball = std::make_shared<LabelVolume>(*before);
  const VoxelBox box = paint(*painted_ball, {38, 43, 35}, 8, 2);
  const std::shared_ptr<const LabelVolume> after = painted_ball;
  View3D view(studio.renderer);
  view.draw(scene_of(before), camera_of(kGrid), kSize, 0, 1);
  const Image first = view.read();
  resources.relabel(before, after, box, Surface::AtOnce);
  CHECK(resources.has(after));
  CHECK_FALSE(resources.has(before));
  view.draw(scene_of(after), camera_of(kGrid), kSize, 1, 1);
  const auto fresh = anew(*after);
  CHECK(view.read().rgba == body_of(studio.renderer, fresh).rgba);
  CHECK(view.read().rgba != first.rgba);
  resources.relabel(after, before, box, Surface::AtOnce);
  view.draw(scene_of(before), camera_of(kGrid), kSize, 2, 1);
  CHECK(view.read().rgba == first.rgba);
  // The volume is changed in place: the view must draw it again although the scene has the same pointer.
  resources.relabel(before, after, box, Surface::AtOnce);
  view.draw(scene_of(after), camera_of(kGrid), kSize, 3, 1);
  resources.relabel(after, after, paint(*painted_ball, {38, 43, 30}, 8, 3), Surface::AtOnce);
  const Image second = view.read();
  view.draw(scene_of(after), camera_of(kGrid), kSize, 4, 1);
  CHECK(view.read().rgba != second.rgba);
}

TEST_CASE("relabel: a volume drawn at a coarser resolution is uploaded anew only where it has changed") {
  for (const int side : {36, 72}) {
    Studio studio(side);
    PassResources& resources = studio.renderer.resources();
    // The number of voxels is odd on each axis, so the last coarse voxels contain fewer than eight voxels.
    const auto volume = std::make_shared<LabelVolume>(*painted(grid_of({91, 95, 99}), [](const glm::dvec3& p) {
      return Label(glm::distance(p, glm::dvec3(45, 47, 49)) < 44 ? 1 + (p.x > 45) : 0);
    }));
    body_of(studio.renderer, volume);
    REQUIRE(studio.renderer.note().find(side == 36 ? "1/4" : "1/2") != std::string::npos);
    const std::vector<std::pair<glm::dvec3, Label>> dabs = {
        {{45, 5, 49}, 3}, {{45, 47, 49}, 3}, {{85, 47, 49}, 0}, {{45, 47, 92}, 2}};
    for (const auto& [centre, label] : dabs) {
      const VoxelBox box = paint(*volume, centre, 7, label);
      const int uploads = resources.uploads();
      resources.relabel(volume, volume, box, Surface::AtOnce);
      CHECK(resources.uploads() == uploads);
      const auto fresh = anew(*volume);
      CHECK(slice_of(studio.renderer, volume, centre).rgba == slice_of(studio.renderer, fresh, centre).rgba);
      CHECK(body_of(studio.renderer, volume).rgba == body_of(studio.renderer, fresh).rgba);
    }
  }
}

TEST_CASE("relabel: a change without room in the textures, and one of a coarse volume, is drawn all the same") {
  Studio studio;
  PassResources& resources = studio.renderer.resources();
  const Grid grid = grid_of({200, 200, 40});
  const auto speck = std::make_shared<LabelVolume>(
      *painted(grid, [](const glm::dvec3& p) { return Label(glm::distance(p, glm::dvec3(20, 20, 20)) < 8); }));
  body_of(studio.renderer, speck);
  for (Label& label : speck->voxels) label = 1;
  resources.relabel(speck, speck, {glm::ivec3(0), grid.size}, Surface::AtOnce);
  const auto fresh = anew(*speck);
  CHECK(slice_of(studio.renderer, speck, {150, 150, 20}).rgba == slice_of(studio.renderer, fresh, {150, 150, 20}).rgba);

  Studio small(64);
  const auto volume =
      std::make_shared<LabelVolume>(*painted(grid_of(glm::ivec3(130)), [](const glm::dvec3&) { return Label(1); }));
  slice_of(small.renderer, volume, {60, 60, 60});
  REQUIRE_FALSE(small.renderer.note().empty());
  paint(*volume, {60, 60, 60}, 20, 2);
  small.renderer.resources().relabel(volume, volume, {glm::ivec3(0), volume->grid.size}, Surface::AtOnce);
  const Image shown = slice_of(small.renderer, volume, {60, 60, 60});
  const auto at = static_cast<size_t>(4 * (kSize.y / 2 * kSize.x + kSize.x / 2));
  CHECK(shown.rgba[at + 1] > shown.rgba[at]);  // the middle is green
}
