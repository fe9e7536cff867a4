// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/scene/weight_colormap.h"

#include "core/binding/heat_diffusion.h"
#include "core/deform/preview_map.h"
#include "core/phantom/phantom.h"
#include "core/rig_io/rig_io.h"
#include "render/passes/pass_resources.h"
#include "tests/render/studio.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

const glm::ivec2 kSize(120, 120);

// A block of tissue and a rig of three bones. `second` gives the second bone's weight of each voxel in 1/65535; the
// rest is the first bone's.
struct Block {
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const TissueVoxels> tissue;
  std::shared_ptr<const SkinWeights> weights;

  Block(const glm::ivec3& size, const std::function<int(const glm::ivec3&)>& second)
      : volume(painted(grid_of(size),
                       [&](const glm::dvec3& p) -> Label {
                         return glm::all(glm::greaterThanEqual(p, glm::dvec3(2))) &&
                                        glm::all(glm::lessThan(p, glm::dvec3(size) - 2.0))
                                    ? 1
                                    : 0;
                       })),
        tissue(std::make_shared<const TissueVoxels>(*volume)),
        weights(of(second)) {}

  std::shared_ptr<const SkinWeights> of(const std::function<int(const glm::ivec3&)>& second) const {
    return with([&](const glm::ivec3& voxel) {
      return quantize({{0, kFullWeight - second(voxel)}, {1, second(voxel)}});
    });
  }
  std::shared_ptr<const SkinWeights> with(const std::function<Influence(const glm::ivec3&)>& influence) const {
    SkinWeights made({"First", "Second", "Third"}, *tissue);
    for (std::int64_t b = 0; b < made.chunk_count(); ++b) {
      SkinWeights::Influences chunk = made.chunk(b);
      const std::int64_t first = tissue->bricks()[b].first;
      tissue->for_each(b, b + 1,
                       [&](std::int64_t place, const glm::ivec3& voxel) { chunk[place - first] = influence(voxel); });
      made.set_chunk(b, chunk);
    }
    return std::make_shared<const SkinWeights>(made);
  }

  Scene scene(WeightDisplay display = WeightDisplay::Active, int bone = 1) const {
    Scene scene = scene_of(volume);
    scene.weights = ShownWeights{.weights = weights,
                                 .tissue = tissue,
                                 .display = display,
                                 .bone = bone,
                                 .swatches = swatches(),
                                 .contours = false};
    return scene;
  }
  static std::shared_ptr<const std::vector<glm::vec3>> swatches() {
    static const auto made =
        std::make_shared<const std::vector<glm::vec3>>(std::vector<glm::vec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    return made;
  }
};

glm::ivec3 bytes(const glm::vec3& colour) { return glm::ivec3(colour * 255.0f + 0.5f); }
int apart(const glm::ivec4& pixel, const glm::ivec3& colour) {
  const glm::ivec3 d = glm::abs(glm::ivec3(pixel) - colour);
  return std::max({d.x, d.y, d.z});
}

// Returns the axial slice camera in which a voxel is four pixels wide.
SliceCamera slice_through(const Block& block, int z) {
  return {.centre = glm::dvec3(glm::dvec2(block.volume->grid.size) / 2.0, z), .millimetres_per_pixel = 0.25};
}
glm::ivec2 pixel_of(const Block& block, int x, int y) {
  const glm::dvec2 off = (glm::dvec2(x, y) - glm::dvec2(block.volume->grid.size) / 2.0) * 4.0;
  return glm::ivec2(glm::floor(off + glm::dvec2(kSize) / 2.0));
}

// Returns the lightness of a colour [CIE 1976].
double lightness(const glm::vec3& srgb) {
  const auto linear = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  const double y = 0.2126 * linear(srgb.r) + 0.7152 * linear(srgb.g) + 0.0722 * linear(srgb.b);
  return y > 216.0 / 24389 ? 116 * std::cbrt(y) - 16 : y * 24389 / 27;
}

}  // namespace

TEST_CASE("weight colours: exact 0 and 1 are colourless, all between has colour, and lightness rises") {
  CHECK(weight_colour(0) == srgb(0x5E6269));
  CHECK(weight_colour(kFullWeight) == srgb(0xFFF4D9));
  CHECK(bytes(weight_colour(1)) == bytes(srgb(0x2B3480)));
  CHECK(bytes(weight_colour(kFullWeight - 1)) == bytes(srgb(0xF3CF45)));
  double before = 0;
  for (int weight = 1; weight < kFullWeight; weight += 500) {
    const double now = lightness(weight_colour(weight));
    CHECK(now > before);
    before = now;
    const glm::vec3 c = weight_colour(weight);
    CHECK(std::max({c.r, c.g, c.b}) - std::min({c.r, c.g, c.b}) > 0.2f);
  }
  CHECK(lightness(kExactOne) > before + 10);
  constexpr double kSteps[] = {25, 39, 52, 61, 70, 78, 84};
  for (std::size_t i = 0; i < kWeightRamp.size(); ++i)
    CHECK(lightness(kWeightRamp[i]) == doctest::Approx(kSteps[i]).epsilon(0.04));
}

TEST_CASE("weight colours: a bone differs from the one it hangs on and from those beside it") {
  Armature rig;
  for (int bone = 0; bone < 40; ++bone)
    rig.bones.push_back(
        {"b" + std::to_string(bone), bone == 0 ? -1 : (bone - 1) / 5, glm::dvec3(0, 0, bone), glm::dvec3(1, 0, bone)});
  const std::vector<glm::vec3> swatches = bone_swatches(rig);
  REQUIRE(swatches.size() == 40);
  for (int a = 0; a < 40; ++a)
    for (int b = 0; b < a; ++b)
      if (rig.bones[a].parent == b || rig.bones[a].parent == rig.bones[b].parent) CHECK(swatches[a] != swatches[b]);
}

TEST_CASE(
    "weights: a slice shows each voxel's weight in the ramp's colour, and exact 0 and 1 on the whole numbers alone") {
  Studio studio;
  SliceView view(studio.renderer);
  // Weights rise along x in steps of four voxels, so the middle of a step is not interpolated. The smallest and the
  // largest weight between 0 and the full weight are included: they must not get the colours of exact 0 and 1.
  constexpr std::array<int, 6> kSteps = {0, 1, 20000, 45000, kFullWeight - 1, kFullWeight};
  const Block block({28, 20, 20}, [&](const glm::ivec3& v) {
    return kSteps[static_cast<std::size_t>(std::clamp((v.x - 2) / 4, 0, 5))];
  });
  view.draw(block.scene(), slice_through(block, 9), SliceDisplay::Labels, kSize);
  const Image image = view.read();
  for (int step = 0; step < 6; ++step)
    for (const int x : {3, 4}) {
      CAPTURE(step);
      CHECK(apart(pixel_of(image, pixel_of(block, 2 + 4 * step + x - 2, 9)), bytes(weight_colour(kSteps[step]))) <= 2);
    }
  // The other bone has the complementary weights.
  view.draw(block.scene(WeightDisplay::Active, 0), slice_through(block, 9), SliceDisplay::Labels, kSize);
  const Image other = view.read();
  for (int step = 0; step < 6; ++step)
    CHECK(apart(pixel_of(other, pixel_of(block, 3 + 4 * step, 9)), bytes(weight_colour(kFullWeight - kSteps[step]))) <=
          2);
  // Bone 2 has no weight anywhere, and -1 means that no bone is selected.
  for (const int bone : {2, -1}) {
    view.draw(block.scene(WeightDisplay::Active, bone), slice_through(block, 9), SliceDisplay::Labels, kSize);
    CHECK(apart(pixel_of(view.read(), pixel_of(block, 20, 9)), bytes(kExactZero)) <= 1);
  }
}

TEST_CASE("weights: between voxels the ramp goes over smoothly, and one voxel of exact 0 stands out at its middle") {
  Studio studio;
  SliceView view(studio.renderer);
  const Block block({28, 28, 20}, [](const glm::ivec3& v) { return v == glm::ivec3(14, 14, 9) ? 0 : 2000 * v.x; });
  view.draw(block.scene(), slice_through(block, 9), SliceDisplay::Labels, kSize);
  const Image image = view.read();
  CHECK(apart(pixel_of(image, pixel_of(block, 14, 14)), bytes(kExactZero)) <= 2);
  const glm::ivec2 from = pixel_of(block, 5, 20);
  for (int step = 0; step < 40; ++step) {
    const double x = 5 + (from.x + step + 0.5 - kSize.x / 2.0) * 0.25 + 14 - 5;  // distance along x, in voxels
    CHECK(apart(pixel_of(image, {from.x + step, from.y}), bytes(ramp_colour(2000 * x / kFullWeight))) <= 3);
  }
}

TEST_CASE("weights: a cut face shows the ramp unshaded, and where light falls on the body its hue") {
  Studio studio;
  constexpr std::array<int, 4> kSteps = {0, 16000, 50000, kFullWeight};
  const Block block({36, 24, 24}, [&](const glm::ivec3& v) {
    return kSteps[static_cast<std::size_t>(std::clamp((v.x - 2) / 8, 0, 3))];
  });
  Scene scene = block.scene();
  const Camera camera = camera_of(block.volume->grid, Projection::Orthographic);
  const auto pixel_at = [&](const Image& image, int step) {
    const double millimetres = 2 * camera.distance * std::tan(camera.field_of_view / 2) / kSize.y;
    return test::pixel_of(
        image, glm::ivec2(kSize.x / 2 + int((2 + 8 * step + 3.5 - camera.centre.x) / millimetres), kSize.y / 2));
  };
  for (const int scale : {1, 0}) {  // 1: full resolution at once; 0: refined gradually
    View3D view(studio.renderer);
    view.draw(scene, camera, kSize, 0, scale);
    for (double now = 1; !view.complete(); now += 0.1) view.draw(scene, camera, kSize, now, scale);
    const Image lit = view.read();
    for (int step = 0; step < 4; ++step) {
      // Shading does not change the order of the colour channels.
      const glm::ivec3 seen(pixel_at(lit, step)), wanted = bytes(weight_colour(kSteps[step]));
      CAPTURE(step);
      CHECK((seen.b > seen.r) == (wanted.b > wanted.r));
      CHECK((seen.g > seen.b) == (wanted.g > wanted.b));
    }
  }
  scene.clip.box = {glm::dvec3(-0.5, 9.5, -0.5), glm::dvec3(36, 24, 24)};
  const Image cut = picture_of(studio.renderer, scene, camera, kSize);
  for (int step = 0; step < 4; ++step) CHECK(apart(pixel_at(cut, step), bytes(weight_colour(kSteps[step]))) <= 2);
}

TEST_CASE("weights: contours run where the weight is a quarter, a half and three quarters") {
  Studio studio;
  const Block block({36, 24, 24}, [](const glm::ivec3& v) { return 65534 * std::clamp(v.x - 2, 0, 31) / 31; });
  Scene scene = block.scene();
  scene.clip.box = {glm::dvec3(-0.5, 9.5, -0.5), glm::dvec3(36, 24, 24)};
  const Camera camera = camera_of(block.volume->grid, Projection::Orthographic);
  const Image plain = picture_of(studio.renderer, scene, camera, kSize);
  scene.weights->contours = true;
  const auto dark_columns = [&](const Image& image, const Image& without, int y) {
    std::vector<int> columns;
    for (int x = 0; x < image.size.x; ++x)
      if (test::pixel_of(image, {x, y}).g < 0.8 * test::pixel_of(without, {x, y}).g) columns.push_back(x);
    return columns;
  };
  const double millimetres = 2 * camera.distance * std::tan(camera.field_of_view / 2) / kSize.y;
  const std::vector<int> body = dark_columns(picture_of(studio.renderer, scene, camera, kSize), plain, kSize.y / 2);
  REQUIRE(body.size() == 3);
  // A contour is one pixel wide. It is drawn in the last column before its position.
  for (int line = 0; line < 3; ++line)
    CHECK(std::abs(body[line] + 1 - (kSize.x / 2 + (2 + 31 * (line + 1) * 0.25 - camera.centre.x) / millimetres)) <= 1);
  // At twice the scale, each contour covers the column before, too.
  scene.line_scale = 2;
  const std::vector<int> broad = dark_columns(picture_of(studio.renderer, scene, camera, kSize), plain, kSize.y / 2);
  std::vector<int> doubled;
  for (const int x : body) doubled.insert(doubled.end(), {x - 1, x});
  CHECK(broad == doubled);
  scene.line_scale = 1;

  SliceView view(studio.renderer);
  const SliceCamera slice{.centre = glm::dvec3(18, 12, 9), .millimetres_per_pixel = 0.25};
  const glm::ivec2 wide(200, 120);
  view.draw(block.scene(), slice, SliceDisplay::Labels, wide);
  const Image without = view.read();
  view.draw(scene, slice, SliceDisplay::Labels, wide);
  const std::vector<int> lines = dark_columns(view.read(), without, 60);
  REQUIRE(lines.size() >= 3);
  for (const int x : lines) {
    const double weight = (18 + (x + 0.5 - 100) * 0.25 - 2) / 31;
    CHECK(std::min({std::abs(weight - 0.25), std::abs(weight - 0.5), std::abs(weight - 0.75)}) <
          0.012);  // the weight changes by this much over one and a half pixels
  }
  scene.line_scale = 2;
  view.draw(scene, slice, SliceDisplay::Labels, wide);
  const std::vector<int> broad_lines = dark_columns(view.read(), without, 60);
  CHECK(broad_lines.size() > lines.size());
  CHECK(broad_lines.size() >= 6);
  CHECK(broad_lines.size() <= 9);
}

TEST_CASE(
    "weights: dominant bones have their swatches, the active one orange, the count of influences has four colours, "
    "mixes blend") {
  Studio studio;
  SliceView view(studio.renderer);
  const Block block({36, 20, 20}, [](const glm::ivec3&) { return 0; });
  Scene scene = block.scene(WeightDisplay::Dominant, 1);
  const std::vector<Influence> steps = {quantize({{0, 1.0}}), quantize({{0, 0.3}, {1, 0.7}}),
                                        quantize({{0, 0.2}, {1, 0.3}, {2, 0.5}})};
  scene.weights->weights = block.with(
      [&](const glm::ivec3& v) { return steps[static_cast<std::size_t>(std::clamp((v.x - 2) / 10, 0, 2))]; });
  const auto at = [&](int step) {
    view.draw(scene, {.centre = glm::dvec3(18, 10, 9), .millimetres_per_pixel = 0.3125}, SliceDisplay::Labels, kSize);
    return test::pixel_of(view.read(), {int(60 + (2 + 10 * step + 5 - 18) / 0.3125), 60});
  };
  CHECK(apart(at(0), {255, 0, 0}) <= 1);
  CHECK(apart(at(1), bytes(kActiveBone)) <= 1);
  CHECK(apart(at(2), {0, 0, 255}) <= 1);
  scene.weights->display = WeightDisplay::Count;
  for (int step = 0; step < 3; ++step) CHECK(apart(at(step), bytes(count_colour(step + 1))) <= 1);
  scene.weights->display = WeightDisplay::Mixed;
  scene.weights->bone = -1;
  CHECK(apart(at(0), {255, 0, 0}) <= 1);
  for (int step = 1; step < 3; ++step)
    CHECK(apart(at(step), bytes(mixed_colour(steps[static_cast<std::size_t>(step)], *Block::swatches()))) <= 2);
}

TEST_CASE("weights: a brick that changes is uploaded alone, and the picture is that of all weights anew") {
  Studio studio;
  const Block block({80, 40, 40}, [](const glm::ivec3& v) { return 800 * v.x; });
  Scene scene = block.scene();
  const Camera camera = camera_of(block.volume->grid);
  View3D view(studio.renderer);
  draw(view, scene, camera, kSize);
  auto& body = studio.renderer.resources().body(block.volume);
  const std::int64_t all = body.weights->texels_uploaded();

  SkinWeights changed = *block.weights;
  const std::int64_t brick = block.tissue->brick_at({40, 2, 20});
  SkinWeights::Influences chunk = changed.chunk(brick);
  for (Influence& influence : chunk) influence = rigid_influence(1);
  changed.set_chunk(brick, chunk);
  scene.weights->weights = std::make_shared<const SkinWeights>(changed);
  const Image after = draw(view, scene, camera, kSize);
  CHECK(body.weights->texels_uploaded() <= 8 * 512);
  CHECK(body.weights->texels_uploaded() >= 512 * 6 / 8);
  CHECK(all > 100 * body.weights->texels_uploaded() / 2);
  // Undo and redo upload as many texels as the dab.
  const std::int64_t dab = body.weights->texels_uploaded();
  for (int again = 0; again < 2; ++again) {
    scene.weights->weights = block.weights;
    draw(view, scene, camera, kSize);
    CHECK(body.weights->texels_uploaded() == dab);
    scene.weights->weights = std::make_shared<const SkinWeights>(changed);
    draw(view, scene, camera, kSize);
    CHECK(body.weights->texels_uploaded() == dab);
  }

  Renderer fresh;
  CHECK(difference(after, picture_of(fresh, scene, camera, kSize)).mean == 0);
  // An equal copy of the weights uploads nothing. Selecting another bone without weights uploads only the texels where
  // the previous bone had weight.
  scene.weights->weights = std::make_shared<const SkinWeights>(changed);
  draw(view, scene, camera, kSize);
  CHECK(body.weights->texels_uploaded() == 0);
}

TEST_CASE(
    "weights: a change of everything comes to the card in several frames, a dab meanwhile in its own, and the picture "
    "is then that of all weights anew") {
  Studio studio;
  const Block block({140, 100, 120}, [](const glm::ivec3& v) { return 400 * v.x; });
  Scene scene = block.scene();
  const Camera camera = camera_of(block.volume->grid);
  View3D view(studio.renderer);
  SliceView slice(studio.renderer);
  SliceCamera cut = slice_through(block, 60);
  double now = 0;
  auto& body = studio.renderer.resources().body(block.volume);
  const int slots = static_cast<int>(body.volume->layout().block_of_slot.size());
  REQUIRE(slots == 80);
  // With a time limit of 0, each frame uploads one lot of WeightTexture::kLot slots, whatever the number of views.
  const auto frame = [&] {
    studio.renderer.begin_frame(0);
    view.draw(scene, camera, kSize, now += 0.2);
    const std::int64_t by_body = body.weights->texels_uploaded();
    slice.draw(scene, cut, SliceDisplay::Labels, kSize);
    CHECK(body.weights->texels_uploaded() == 0);
    CHECK(slice.complete() == body.weights->complete());
    return by_body;
  };
  const auto to_the_end = [&] {
    int frames = 0;
    do {
      CHECK(frame() <= std::int64_t{WeightTexture::kLot} * kSlot * kSlot * kSlot);
      ++frames;
      if (!slice.complete()) CHECK(!view.complete());
    } while (!slice.complete() && frames < 1000);
    return frames;
  };
  const auto is_as_anew = [&] {
    while (!view.complete()) CHECK(frame() == 0);
    Renderer fresh;
    View3D other(fresh);
    double then = 0;
    do other.draw(scene, camera, kSize, then += 0.2);
    while (!other.complete());
    CHECK(difference(view.read(), other.read()).mean < 0.5);
    view.draw(scene, camera, kSize, now += 0.2, 1);
    CHECK(body.weights->texels_uploaded() == 0);
    CHECK(difference(view.read(), picture_of(fresh, scene, camera, kSize)).mean == 0);
    for (const int z : {12, 44, 60, 112}) {
      SliceView there(studio.renderer), anew(fresh);
      const SliceCamera whole{.centre = glm::dvec3(70, 50, z), .millimetres_per_pixel = 1.2};
      there.draw(scene, whole, SliceDisplay::Labels, kSize);
      anew.draw(scene, whole, SliceDisplay::Labels, kSize);
      CHECK(difference(there.read(), anew.read()).mean == 0);
    }
  };
  const int lots = (slots + WeightTexture::kLot - 1) / WeightTexture::kLot;
  CHECK(to_the_end() == lots);  // the first upload takes one frame per lot of slots
  is_as_anew();

  const auto before = scene.weights->weights;
  const auto edited = block.of([](const glm::ivec3& v) { return 400 * v.x + 100; });
  scene.weights->weights = edited;
  CHECK(to_the_end() == lots);
  is_as_anew();
  // The edit is undone, and dabs are made before its upload is complete: one in a slot that is being computed, and one
  // in the last slot.
  SkinWeights dabbed = *before;
  const auto dab_at = [&](const glm::ivec3& voxel) {
    const std::int64_t brick = block.tissue->brick_at(voxel);
    dabbed.set_chunk(brick, SkinWeights::Influences(dabbed.chunk(brick).size(), rigid_influence(1)));
    scene.weights->weights = std::make_shared<const SkinWeights>(dabbed);
    cut = {.centre = glm::dvec3(voxel), .millimetres_per_pixel = 0.25};
    frame();
    CHECK(!slice.complete());
    CHECK(apart(test::pixel_of(slice.read(), kSize / 2), bytes(kExactOne)) <= 2);
  };
  scene.weights->weights = before;
  frame();
  dab_at({76, 44, 12});
  dab_at({132, 92, 114});
  to_the_end();
  is_as_anew();

  // Another display needs other texels. Where these are not uploaded yet, the tissue's own colour is shown.
  scene.weights->display = WeightDisplay::Dominant;
  frame();
  CHECK(!slice.complete());
  CHECK(apart(test::pixel_of(slice.read(), kSize / 2), {230, 26, 26}) <= 2);
  to_the_end();
  is_as_anew();
}

TEST_CASE("weights: another bone, display or contours follow no ray again, and the picture is as drawn anew") {
  Studio studio;
  const Block block({40, 40, 60}, [](const glm::ivec3& v) { return std::min(kFullWeight, 1100 * v.z); });
  Scene scene = block.scene();
  const Camera camera = camera_of(block.volume->grid);
  View3D view(studio.renderer);
  const auto rest = [&](View3D& v) {
    double now = 0;
    do v.draw(scene, camera, kSize, now += 0.2);
    while (!v.complete());
    return now;
  };
  double now = rest(view);
  const std::int64_t followed = view.rays_followed();
  REQUIRE(followed > 0);
  for (const auto& change : std::initializer_list<std::function<void(ShownWeights&)>>{
           [](ShownWeights& w) { w.bone = 0; }, [](ShownWeights& w) { w.contours = true; },
           [](ShownWeights& w) { w.display = WeightDisplay::Count; },
           [](ShownWeights& w) { w.display = WeightDisplay::Active; }}) {
    change(*scene.weights);
    view.draw(scene, camera, kSize, now += 0.01);
    CHECK(view.rays_followed() == followed);
    Renderer other;
    CHECK(difference(view.read(), picture_of(other, scene, camera, kSize)).mean < 0.3);
  }
  scene.weights.reset();
  view.draw(scene, camera, kSize, now += 0.01);
  CHECK(view.rays_followed() == followed);
}

TEST_CASE(
    "weights: of a picture at rest, what a brush changes is drawn anew where it is, and the rest stays as fine as it "
    "was") {
  Studio studio;
  const Block block({80, 40, 40}, [](const glm::ivec3& v) { return 800 * v.x; });
  Scene scene = block.scene();
  const Camera camera = camera_of(block.volume->grid, Projection::Orthographic);
  double now = 0;
  const auto rest = [&](View3D& picture) {
    do picture.draw(scene, camera, kSize, now += 0.2);
    while (!picture.complete());
    return picture.read();
  };
  View3D view(studio.renderer);
  const Image before = rest(view);
  const std::int64_t followed = view.rays_followed();
  SkinWeights changed = *block.weights;
  for (std::int64_t b = 0; b < changed.chunk_count(); ++b) {
    const glm::ivec3 corner = block.tissue->bricks()[b].corner;
    if (corner.x != 40) continue;
    SkinWeights::Influences chunk = changed.chunk(b);
    for (Influence& influence : chunk) influence = rigid_influence(1);
    changed.set_chunk(b, chunk);
  }
  scene.weights->weights = std::make_shared<const SkinWeights>(changed);
  view.draw(scene, camera, kSize, now += 0.01);
  CHECK(view.rays_followed() == followed);
  const Image after = view.read();
  const double millimetres = 2 * camera.distance * std::tan(camera.field_of_view / 2) / kSize.y;
  int inside = 0, outside = 0;
  for (int y = 0; y < kSize.y; ++y)
    for (int x = 0; x < kSize.x; ++x) {
      const double at = camera.centre.x + (x + 0.5 - kSize.x / 2) * millimetres;  // position along x, in voxels
      const bool differs = apart(test::pixel_of(before, {x, y}), glm::ivec3(test::pixel_of(after, {x, y}))) > 0;
      if (at > 35 && at < 53) inside += differs;
      else outside += differs;
    }
  CHECK(inside > 200);
  CHECK(outside == 0);
  // After refinement, the picture equals that of weights that were there from the start.
  View3D fresh(studio.renderer);
  CHECK(difference(rest(view), rest(fresh)).mean < 0.5);
}

TEST_CASE(
    "weights: in small textures, and where the volume is drawn coarser, the picture is the same but for its steps") {
  const Block block({70, 60, 80},
                    [](const glm::ivec3& v) { return v.z < 20 ? 0 : std::min(kFullWeight, 1500 * (v.z - 20)); });
  Scene scene = block.scene();
  const Camera camera = camera_of(block.volume->grid);
  Studio studio;
  Renderer small(80), tiny(40);
  const Image picture = picture_of(studio.renderer, scene, camera, kSize),
              coarse = picture_of(tiny, scene, camera, kSize);
  // A driver may round differently in a texture of another size: one level of one channel in a pixel out of 5000.
  CHECK(difference(picture, picture_of(small, scene, camera, kSize)).mean < 2e-4);
  CHECK(tiny.resources().body(block.volume).volume->halvings() > 0);
  scene.weights.reset();
  CHECK(difference(picture, coarse).mean <
        1.5 *
            difference(picture_of(studio.renderer, scene, camera, kSize), picture_of(tiny, scene, camera, kSize)).mean);
}

TEST_CASE("weights: a posed body shows the weights of the voxels that its map leads to") {
  Phantom phantom = make_arm_phantom(4);
  const auto volume = std::make_shared<const LabelVolume>(phantom.volume);
  const auto tissue = std::make_shared<const TissueVoxels>(*volume);
  const auto weights = std::make_shared<const SkinWeights>(diffuse_heat(*volume, phantom.tissues, phantom.armature));
  const int forearm = require_bone(phantom.armature, "Forearm");
  Pose pose = rest_pose(phantom.armature);
  flex(pose, phantom.armature, forearm, 70);

  Scene scene = scene_of(volume, std::make_shared<const LabelLooks>(looks_of(phantom.tissues)));
  scene.pose = LivePreview(volume, phantom.tissues, *tissue, *weights, 2)
                   .update(posed_from_rest(phantom.armature, pose), Blend::DualQuaternion);
  scene.weights =
      ShownWeights{.weights = weights,
                   .tissue = tissue,
                   .display = WeightDisplay::Dominant,
                   .bone = forearm,
                   .swatches = std::make_shared<const std::vector<glm::vec3>>(bone_swatches(phantom.armature)),
                   .contours = false};
  const auto dominant = [&](const glm::ivec3& voxel) {
    const int brick = tissue->brick_at(voxel);
    return int(weights->chunk(brick)[static_cast<std::size_t>(tissue->index_of(voxel) - tissue->bricks()[brick].first)]
                   .bone[0]);
  };
  const auto colour = [&](int bone) {
    return bytes(bone == forearm ? kActiveBone : (*scene.weights->swatches)[static_cast<std::size_t>(bone)]);
  };

  // In a slice across the bent elbow, compares each pixel with the colour of the bone that has most weight there.
  Studio studio;
  SliceView view(studio.renderer);
  const Bone& bone = phantom.armature.bones[static_cast<std::size_t>(forearm)];
  const SliceCamera slice{.axis = SliceAxis::Sagittal, .centre = bone.head, .millimetres_per_pixel = 2.3};
  view.draw(scene, slice, SliceDisplay::Labels, kSize);
  const Image image = view.read();
  const SliceFrame frame = frame_of(slice.axis);
  const AffineTransform to_voxel = voxel_from_world(volume->grid);
  int seen = 0, right = 0;
  for (int y = 0; y < kSize.y; ++y)
    for (int x = 0; x < kSize.x; ++x) {
      const glm::dvec2 off = (glm::dvec2(x, y) + 0.5 - glm::dvec2(kSize) / 2.0) * slice.millimetres_per_pixel;
      const auto rest = scene.pose->rest_at(to_voxel * (slice.centre + frame.right * off.x + frame.down * off.y));
      if (!rest) continue;
      const glm::ivec3 voxel(glm::floor(*rest + 0.5));
      if (volume->at_or_air(voxel) == 0) continue;
      ++seen;
      const glm::ivec4 pixel = test::pixel_of(image, {x, y});
      // Borders of tissues are darker by the factor 0.86.
      right += apart(pixel, colour(dominant(voxel))) <= 2 ||
               apart(pixel, glm::ivec3(glm::vec3(colour(dominant(voxel))) * 0.86f)) <= 3;
    }
  CHECK(seen > 500);
  CHECK(right > 0.98 * seen);

  // In the 3D view, compares the hue of each pixel with that of the bone that has most weight there.
  const Camera camera = camera_of(volume->grid, Projection::Perspective, StandardView::Left);
  View3D body(studio.renderer);
  const Image lit = draw(body, scene, camera, kSize * 2);
  seen = right = 0;
  for (int y = 0; y < lit.size.y; y += 3)
    for (int x = 0; x < lit.size.x; x += 3) {
      const auto hit = body.pick({x, y});
      if (!hit || volume->at_or_air(hit->voxel) == 0) continue;
      const glm::vec3 wanted(colour(dominant(hit->voxel))), got(glm::ivec3(test::pixel_of(lit, {x, y})));
      if (glm::length(got) < 30) continue;
      ++seen;
      right += glm::dot(glm::normalize(wanted), glm::normalize(got)) > 0.985f;
    }
  CHECK(seen > 300);
  CHECK(right > 0.9 * seen);
}

TEST_CASE("weights: a field shows each voxel in its own colour, and another field takes its place") {
  Studio studio;
  SliceView slice(studio.renderer);
  const Block block({16, 14, 12}, [](const glm::ivec3&) { return 0; });
  Scene scene = block.scene();
  const auto field = [&](int shift) {
    std::vector<glm::u8vec3> colours;
    block.tissue->for_each([&](std::int64_t, const glm::ivec3& v) {
      colours.push_back(glm::u8vec3(v.x / 4 * 60 + shift, 40, v.y / 4 * 60));
    });
    return std::make_shared<const std::vector<glm::u8vec3>>(std::move(colours));
  };
  for (const int shift : {10, 60}) {
    scene.weights =
        ShownWeights{.tissue = block.tissue, .display = WeightDisplay::Field, .field = field(shift), .contours = false};
    slice.draw(scene, slice_through(block, 6), SliceDisplay::Labels, kSize);
    const Image picture = slice.read();
    // Four voxels share a colour, so the two middle ones are not interpolated with other colours.
    for (const glm::ivec2 v : {glm::ivec2(5, 5), glm::ivec2(9, 6), glm::ivec2(10, 9)})
      CHECK(apart(pixel_of(picture, pixel_of(block, v.x, v.y)), {v.x / 4 * 60 + shift, 40, v.y / 4 * 60}) <= 1);
  }
  scene.weights->field = std::make_shared<const std::vector<glm::u8vec3>>(3);
  CHECK_THROWS_AS(slice.draw(scene, slice_through(block, 6), SliceDisplay::Labels, kSize), std::logic_error);
}
