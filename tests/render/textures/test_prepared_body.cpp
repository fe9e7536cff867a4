// SPDX-License-Identifier: AGPL-3.0-or-later
#include <epoxy/gl.h>

#include "render/passes/pass_resources.h"

#include "tests/render/studio.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

constexpr glm::ivec2 kSize{160, 160};

// Returns a ball with a core, of so many blocks that their upload takes several frames.
std::shared_ptr<const LabelVolume> ball() {
  return painted(grid_of({120, 120, 120}), [](const glm::dvec3& p) -> Label {
    const double r = glm::length(p - glm::dvec3(60));
    return r < 30 ? 2 : r < 55 ? 1 : 0;
  });
}

bool same_pixels(const Image& a, const Image& b) { return a.size == b.size && a.rgba == b.rgba; }

// Makes a body ready to be drawn, and returns in how many frames. With a time limit of 0, each frame uploads one slot.
int make_ready(Renderer& renderer, PreparedBody& body) {
  constexpr int kMostFrames = 10'000;
  for (int frames = 1; frames <= kMostFrames; ++frames) {
    renderer.begin_frame(0);
    if (renderer.upload(body)) return frames;
  }
  FAIL("the body is never ready");
  return 0;
}

}  // namespace

TEST_CASE("prepared body: uploaded over several frames, it is drawn as one that is uploaded at once") {
  for (const Display display : {Display::Solid, Display::XRay, Display::Tissue}) {
    CAPTURE(static_cast<int>(display));
    const auto volume = ball();
    Scene scene = scene_of(volume);
    scene.display = display;
    const Camera camera = camera_of(volume->grid);
    Studio at_once;
    const Image expected = picture_of(at_once.renderer, scene, camera, kSize);
    Studio studio;
    const auto body = prepared_body(volume, *scene.looks, display, studio.renderer.limits(), no_progress());
    CHECK(make_ready(studio.renderer, *body) > 20);
    const auto& resident = studio.renderer.resources().body(volume);
    REQUIRE(resident.layers.size() >= 1);
    const int revision = resident.layers[0]->revision();
    CHECK(same_pixels(picture_of(studio.renderer, scene, camera, kSize), expected));
    // The revision shows that no layer was computed or uploaded again.
    CHECK(resident.layers[0]->revision() == revision);
    studio.renderer.begin_frame(0);
    CHECK(studio.renderer.upload(*body));
  }
}

TEST_CASE("prepared body: drawn before its upload is complete, it is complete") {
  const auto volume = ball();
  const Scene scene = scene_of(volume);
  const Camera camera = camera_of(volume->grid);
  Studio at_once;
  const Image expected = picture_of(at_once.renderer, scene, camera, kSize);
  // The body is drawn while its labels are uploaded, and later while its surface field is.
  for (const int frames : {1, 20, 40}) {
    CAPTURE(frames);
    Studio studio;
    const auto body = prepared_body(volume, *scene.looks, scene.display, studio.renderer.limits(), no_progress());
    for (int frame = 0; frame < frames; ++frame) {
      studio.renderer.begin_frame(0);
      CHECK_FALSE(studio.renderer.upload(*body));
    }
    CHECK(same_pixels(picture_of(studio.renderer, scene, camera, kSize), expected));
    studio.renderer.begin_frame(0);
    CHECK(studio.renderer.upload(*body));
  }
}

TEST_CASE("prepared body: a volume too large for the textures is prepared at half its resolution") {
  const auto volume = ball();
  const Scene scene = scene_of(volume);
  Studio studio(2 * kSlot);
  const auto body = prepared_body(volume, *scene.looks, scene.display, studio.renderer.limits(), no_progress());
  CHECK(body->volume.halvings > 0);
  make_ready(studio.renderer, *body);
  CHECK(studio.renderer.note().empty());  // there is no message, as the body is not shown yet
  picture_of(studio.renderer, scene, camera_of(volume->grid), kSize);
  CHECK(studio.renderer.note().starts_with("Shown at 1/2 of its resolution"));
}

TEST_CASE("prepared body: one whose upload fails is drawn all the same, one that nobody wants any more is freed") {
  Studio studio;
  auto volume = ball();
  const Scene scene = scene_of(volume);
  const auto body = prepared_body(volume, *scene.looks, scene.display, studio.renderer.limits(), no_progress());
  body->volume.layout.slots = glm::ivec3(1000);  // a texture of so many slots is larger than drivers allow
  studio.renderer.begin_frame(0);
  CHECK_THROWS_AS(studio.renderer.upload(*body), Error);
  const Image shown = picture_of(studio.renderer, scene, camera_of(volume->grid), kSize);
  Studio at_once;
  CHECK(same_pixels(shown, picture_of(at_once.renderer, scene, camera_of(volume->grid), kSize)));

  auto unwanted = ball();
  const auto never = prepared_body(unwanted, *scene.looks, scene.display, studio.renderer.limits(), no_progress());
  studio.renderer.begin_frame(0);
  CHECK_FALSE(studio.renderer.upload(*never));
  CHECK(studio.renderer.note().empty());
  CHECK(studio.renderer.resources().body_count() == 1);
}

TEST_CASE(
    "prepared body: a grey image is uploaded before its first picture, and so is the body that is drawn already") {
  const auto volume = ball();
  Studio studio;
  ShownGrey grey;
  std::vector<float> values(volume->voxels.begin(), volume->voxels.end());
  grey.image = std::make_shared<const GreyLevels>(grey_levels(volume->grid, values));
  Scene scene = scene_of(volume);
  picture_of(studio.renderer, scene, camera_of(volume->grid), kSize);
  scene.display = Display::Image;
  scene.grey = grey;
  const auto body =
      prepared_body(volume, *scene.looks, Display::Solid, studio.renderer.limits(), no_progress(), scene.grey);
  make_ready(studio.renderer, *body);
  studio.renderer.begin_frame(0);
  View3D view(studio.renderer);
  view.draw(scene, camera_of(volume->grid), kSize, 0);
  CHECK(studio.renderer.resources().grey(scene.grey, PassResources::Extent::InTime)->complete());
  CHECK_FALSE(studio.renderer.resources().upload_time->used);  // the picture itself uploaded nothing
}

TEST_CASE("prepared body: its shaders are linked before its first picture") {
  const auto volume = ball();
  const Scene scene = scene_of(volume);
  Studio studio;
  const auto body = prepared_body(volume, *scene.looks, scene.display, studio.renderer.limits(), no_progress());
  make_ready(studio.renderer, *body);
  // Drivers number programs in ascending order, so programs that the picture links come after this one.
  const GLuint last = glCreateProgram();
  picture_of(studio.renderer, scene, camera_of(volume->grid), kSize);
  for (GLuint later = last + 1; later < last + 100; ++later) CHECK_FALSE(glIsProgram(later));
  glDeleteProgram(last);
}

TEST_CASE("prepared body: an empty volume, and a cancelled one") {
  const auto volume = painted(grid_of({64, 64, 64}), [](const glm::dvec3&) -> Label { return 0; });
  const Scene scene = scene_of(volume);
  Studio studio;
  const auto body = prepared_body(volume, *scene.looks, scene.display, studio.renderer.limits(), no_progress());
  make_ready(studio.renderer, *body);
  CHECK(studio.renderer.resources().body(volume).layers[0]->hull().empty());
  picture_of(studio.renderer, scene, camera_of(volume->grid), kSize);

  class Stopped : public Progress {
   public:
    Stopped() { cancel(); }
  } stopped;
  CHECK_THROWS_AS(prepared_body(ball(), *scene.looks, scene.display, {.side = 2048}, stopped), Cancelled);
}
