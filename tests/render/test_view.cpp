// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/view.h"

#include <algorithm>
#include <numbers>
#include <random>

#include "core/volume_io/volume_io.h"
#include "render/gl/object.h"
#include "tests/render/studio.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::render;
using namespace limber::test;

namespace {

const glm::ivec2 kSize(200, 200);

// Returns a ball of label 1 with a core of label 3, both in the centre of the grid.
std::shared_ptr<const LabelVolume> ball(const Grid& grid, double radius, double core = 0) {
  const glm::dvec3 middle = world_from_voxel(grid) * (glm::dvec3(grid.size - 1) / 2.0);
  return painted(grid, [=](const glm::dvec3& p) -> Label {
    const double r = glm::length(p - middle);
    return r <= core ? 3 : r <= radius ? 1 : 0;
  });
}

// Returns a body without symmetry: three overlapping balls of different labels, and a thread one voxel thick.
std::shared_ptr<const LabelVolume> lump(const Grid& grid) {
  const AffineTransform to_voxel = voxel_from_world(grid);
  const glm::dvec3 size(grid.size);
  return painted(grid, [=](const glm::dvec3& world) -> Label {
    const glm::dvec3 p = (to_voxel * world + 0.5) / size;
    if (glm::length(p - glm::dvec3(0.35, 0.5, 0.4)) < 0.24) return 1;
    if (glm::length(p - glm::dvec3(0.6, 0.4, 0.6)) < 0.2) return 2;
    if (glm::length(p - glm::dvec3(0.5, 0.65, 0.3)) < 0.16) return 3;
    return 0;
  });
}

// Counts how well picks agree with rays that are traced on the CPU.
struct Agreement {
  int both = 0, only_one = 0, far = 0, other_label = 0;
};
Agreement compare_with_cpu(const View3D& view, const Scene& scene, const Camera& camera, double voxel) {
  Agreement result;
  const auto seen = [&](Label label) { return label < scene.looks->size() && (*scene.looks)[label].visible; };
  const auto cpu_hit = [&](int x, int y) {
    return follow(*scene.volume, ray_through(camera, glm::dvec2(x, y) + 0.5, kSize), seen);
  };
  for (int y = 3; y < kSize.y; y += 6)
    for (int x = 3; x < kSize.x; x += 6) {
      const auto cpu = cpu_hit(x, y);
      const auto gpu = view.pick({x, y});
      if (cpu.has_value() != gpu.has_value()) {
        // Rays at the rim are not compared, because the smooth surface lies inside the voxels' surface.
        bool rim = false;
        for (const glm::ivec2 off : {glm::ivec2(5, 0), glm::ivec2(-5, 0), glm::ivec2(0, 5), glm::ivec2(0, -5)})
          rim |= cpu_hit(x + off.x, y + off.y).has_value() != cpu.has_value();
        result.only_one += !rim;
      }
      if (!cpu || !gpu) continue;
      ++result.both;
      result.far += glm::length(cpu->point - gpu->point) > 2.5 * voxel;
      result.other_label += scene.volume->at(gpu->voxel) != gpu->label || scene.volume->at(cpu->voxel) != gpu->label;
    }
  return result;
}

}  // namespace

TEST_CASE("view: the silhouette of a ball has the area of its projection, whatever the spacing") {
  Studio studio;
  for (const glm::dvec3& spacing : {glm::dvec3(1), glm::dvec3(0.8, 1.6, 1.1)}) {
    const Grid grid = grid_of(glm::ivec3(glm::dvec3(70) / spacing), spacing);
    const double radius = 25;
    const Scene scene = scene_of(ball(grid, radius));
    for (const StandardView side : {StandardView::Front, StandardView::Left, StandardView::Top}) {
      const Camera camera = camera_of(grid, Projection::Orthographic, side);
      const double millimetres = 2 * camera.distance * std::tan(camera.field_of_view / 2) / kSize.y;
      const double expected = std::numbers::pi * radius * radius / (millimetres * millimetres);
      CHECK(covered(picture_of(studio.renderer, scene, camera, kSize)) == doctest::Approx(expected).epsilon(0.045));
    }
  }
}

TEST_CASE("view: in perspective a ball covers the cone that touches it") {
  Studio studio;
  const Grid grid = grid_of({64, 64, 64});
  const double radius = 24;
  const Camera camera = camera_of(grid);
  const double sine = radius / camera.distance, tangent = sine / std::sqrt(1 - sine * sine);
  const double pixels = tangent * kSize.y / 2 / std::tan(camera.field_of_view / 2);
  CHECK(covered(picture_of(studio.renderer, scene_of(ball(grid, radius)), camera, kSize)) ==
        doctest::Approx(std::numbers::pi * pixels * pixels).epsilon(0.045));
}

TEST_CASE("view: what is picked agrees with rays followed on the CPU, on mirrored, oblique and stretched grids too") {
  Studio studio;
  Grid straight = grid_of({60, 52, 48}), mirrored = straight, oblique = grid_of({60, 40, 30}, {1, 1.4, 1.9});
  mirrored.direction = glm::dmat3({-1, 0, 0}, {0, 1, 0}, {0, 0, -1});
  mirrored.direction[2] = {0, 0, 1};
  oblique.direction = glm::mat3_cast(glm::angleAxis(0.6, glm::normalize(glm::dvec3(1, 2, 3))));
  for (const Grid& grid : {straight, mirrored, oblique})
    for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
      const Scene scene = scene_of(lump(grid));
      const Camera camera = zoomed(orbited(camera_of(grid, projection), {75, -50}), 0.7);
      View3D view(studio.renderer);
      view.draw(scene, camera, kSize, 0, 1);
      const Agreement agreement =
          compare_with_cpu(view, scene, camera, std::max({grid.spacing.x, grid.spacing.y, grid.spacing.z}));
      CHECK(agreement.both > 60);
      CHECK(agreement.only_one <= 2);
      CHECK(agreement.far <= agreement.both / 25);
      CHECK(agreement.other_label <= agreement.both / 12);
    }
}

TEST_CASE("view: threads and sheets of one voxel are not lost") {
  Studio studio;
  const Grid grid = grid_of({40, 40, 40});
  const auto thin = painted(grid, [](const glm::dvec3& p) -> Label {
    if (p.x == 10 && p.y == 20) return 1;                                    // a thread along z
    return p.x == 26 && p.z > 8 && p.z < 30 && p.y > 8 && p.y < 30 ? 2 : 0;  // a sheet one voxel thick
  });
  const Camera camera = orbited(camera_of(grid, Projection::Orthographic), {60, 0});
  View3D view(studio.renderer);
  const Scene scene = scene_of(thin);
  view.draw(scene, camera, kSize, 0, 1);
  int found = 0;
  for (int z = 4; z < 36; ++z) {
    glm::dvec2 pixel;
    REQUIRE(project(camera, {10, 20, z}, kSize, pixel));
    const auto hit = view.pick(glm::ivec2(pixel));
    found += hit && hit->label == 1;
  }
  CHECK(found == 32);
  glm::dvec2 pixel;
  REQUIRE(project(camera, {26, 20, 20}, kSize, pixel));
  REQUIRE(view.pick(glm::ivec2(pixel)));
  CHECK(view.pick(glm::ivec2(pixel))->label == 2);
}

TEST_CASE("view: normals point away from a ball's middle") {
  Studio studio;
  const Grid grid = grid_of({64, 64, 64});
  const Scene scene = scene_of(ball(grid, 24));
  const Camera camera = orbited(camera_of(grid), {40, 30});
  View3D view(studio.renderer);
  view.draw(scene, camera, kSize, 0, 1);
  double worst = 1;
  for (const glm::ivec2 pixel : {glm::ivec2(100, 100), glm::ivec2(80, 110), glm::ivec2(125, 90), glm::ivec2(100, 70)}) {
    const auto hit = view.pick(pixel);
    REQUIRE(hit);
    worst = std::min(worst, glm::dot(hit->normal, glm::normalize(hit->point - glm::dvec3(31.5))));
  }
  CHECK(worst > 0.975);
}

TEST_CASE("view: a mirrored file of the same body gives the same picture") {
  Studio studio;
  const Grid grid = grid_of({50, 44, 60}, {1, 1.2, 0.9});
  const auto volume = lump(grid);
  auto mirrored = std::make_shared<LabelVolume>(*volume);
  mirrored->grid.direction[0] *= -1.0;
  mirrored->grid.origin += grid.direction[0] * grid.spacing.x * double(grid.size.x - 1);
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) mirrored->at({x, y, z}) = volume->at({grid.size.x - 1 - x, y, z});
  const Camera camera = orbited(camera_of(grid), {-70, 35});
  const auto refined = [&](const std::shared_ptr<const LabelVolume>& body) {
    View3D view(studio.renderer);
    const Scene scene = scene_of(body);
    for (double now = 0; !view.complete(); now += 1) view.draw(scene, camera, kSize, now);
    return view.read();
  };
  const Difference d = difference(refined(volume), refined(mirrored));
  CHECK(d.mean < 0.5);
  CHECK(d.share < 0.01);
}

TEST_CASE("view: a volume in many small textures gives the picture of one in a large texture") {
  const Grid grid = grid_of({140, 70, 90});
  const auto volume = lump(grid);
  const Camera camera = orbited(camera_of(grid), {35, -20});
  const auto picture = [&](int largest_texture, Display display) {
    Studio studio(largest_texture);
    Scene scene = scene_of(volume);
    scene.display = display;
    Image image = picture_of(studio.renderer, scene, camera, kSize);
    CHECK(studio.renderer.note().empty());
    return image;
  };
  for (const Display display : {Display::Solid, Display::XRay}) {
    const Image whole = picture(0, display);
    for (const int largest : {256, 108}) {
      const Difference d = difference(whole, picture(largest, display));
      CHECK(d.mean < 0.1);
      CHECK(d.share < 0.002);
    }
  }
}

TEST_CASE("view: the arm looks the same when textures may have 256 texels an axis") {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  VolumeFile file = read_volume(shared_path("data/bender/man-arm-2mm.mha"));
  const auto looks = std::make_shared<const LabelLooks>(looks_of(merge_tissue_tables(file.tissues, nullptr)));
  const auto volume = std::make_shared<const LabelVolume>(std::move(file.volume));
  const Camera camera = camera_of(volume->grid);
  const auto picture = [&](int largest_texture) {
    Studio studio(largest_texture);
    return picture_of(studio.renderer, scene_of(volume, looks), camera, {320, 240});
  };
  CHECK(difference(picture(0), picture(256)).share < 0.002);
}

TEST_CASE("view: a volume too large for the driver is drawn coarser, and says so") {
  Studio studio(36);  // 36 texels per axis: a texture holds one block, so four textures are used
  const Grid grid = grid_of({90, 90, 90});
  const Scene scene = scene_of(ball(grid, 38));
  const Camera camera = camera_of(grid, Projection::Orthographic);
  const double millimetres = 2 * camera.distance * std::tan(camera.field_of_view / 2) / kSize.y;
  const Image coarse = picture_of(studio.renderer, scene, camera, kSize);
  CHECK(studio.renderer.note().find("1/4") != std::string::npos);
  CHECK(covered(coarse) == doctest::Approx(std::numbers::pi * 38 * 38 / (millimetres * millimetres)).epsilon(0.08));
}

TEST_CASE("view: a volume beyond the limit of memory is drawn coarser, and says so") {
  const Grid grid = grid_of({90, 90, 90});
  const Scene scene = scene_of(ball(grid, 38));
  const Camera camera = camera_of(grid, Projection::Orthographic);
  const auto picture = [&](std::int64_t bytes, const std::string& note) {
    Studio studio;
    studio.renderer.limit_memory(bytes);
    Image image = picture_of(studio.renderer, scene, camera, kSize);
    CHECK((note.empty() ? studio.renderer.note().empty() : studio.renderer.note().find(note) != std::string::npos));
    return image;
  };
  const std::int64_t whole = 27 * 36 * 36 * 36 * 3;
  const Image full = picture(whole, "");
  const Image half = picture(whole - 1, "1/2");
  CHECK(difference(full, half).share > 0);
  CHECK(difference(full, half).share < 0.05);
  picture(1, "1/8");  // 1/8 is the coarsest resolution, so it is drawn although it needs more than one byte
}

TEST_CASE("view: a volume for which there is no room at all is refused in one sentence") {
  Studio studio(8);
  View3D view(studio.renderer);
  const Grid grid = grid_of({40, 40, 40});
  CHECK_THROWS_WITH_AS(view.draw(scene_of(ball(grid, 10)), camera_of(grid), kSize, 0, 1), doctest::Contains("no room"),
                       Error);
}

TEST_CASE("view: a skin one voxel thick, closed by edges alone, hides what lies beneath from everywhere") {
  Studio studio;
  const Grid grid = grid_of({60, 60, 60});
  LabelVolume body = *ball(grid, 22);
  for (Label& label : body.voxels) label = label ? 3 : 0;
  const LabelVolume flesh = body;
  for (int z = 1; z < 59; ++z)
    for (int y = 1; y < 59; ++y)
      for (int x = 1; x < 59; ++x)
        for (int axis = 0; axis < 3; ++axis)
          for (const int sign : {-1, 1}) {
            glm::ivec3 beside(x, y, z);
            beside[axis] += sign;
            if (flesh.at({x, y, z}) && !flesh.at(beside)) body.at({x, y, z}) = 1;
          }
  const Scene scene = scene_of(std::make_shared<const LabelVolume>(body));
  for (const glm::dvec2& turn : {glm::dvec2(0, 0), glm::dvec2(75, -50), glm::dvec2(-160, 90)}) {
    View3D view(studio.renderer);
    view.draw(scene, orbited(camera_of(grid), turn), kSize, 0, 1);
    int skin = 0, other = 0;
    for (int y = 0; y < kSize.y; y += 3)
      for (int x = 0; x < kSize.x; x += 3)
        if (const auto hit = view.pick({x, y})) ++(hit->label == 1 ? skin : other);
    INFO(skin, " of skin, ", other, " of what lies beneath");
    CHECK(skin > 300);
    CHECK(other == 0);
  }
}

TEST_CASE("view: hiding a label shows what lies beneath, and showing it again gives the first picture") {
  Studio studio;
  const Grid grid = grid_of({64, 64, 64});
  const auto volume = ball(grid, 26, 12);
  const Camera camera = camera_of(grid);
  View3D view(studio.renderer);
  const auto all = plain_looks();
  auto some = std::make_shared<LabelLooks>(*all);
  (*some)[1].visible = false;

  const Image first = draw(view, scene_of(volume, all), camera, kSize);
  CHECK(view.pick({100, 100})->label == 1);
  draw(view, scene_of(volume, some), camera, kSize);
  CHECK(view.pick({100, 100})->label == 3);
  const Image changed = draw(view, scene_of(volume, some), camera, kSize);
  const Image again = draw(view, scene_of(volume, all), camera, kSize);
  CHECK(difference(first, again).share < 0.001);

  // The picture equals that of a renderer that never showed the hidden labels.
  Studio fresh;
  CHECK(difference(changed, picture_of(fresh.renderer, scene_of(volume, some), camera, kSize)).share < 0.001);
}

TEST_CASE("view: a clip box cuts the body open, and the cut shows labels as they are") {
  Studio studio;
  const Grid grid = grid_of({64, 64, 64});
  Scene scene = scene_of(ball(grid, 26, 12));
  scene.clip.box = {glm::dvec3(-0.5, 31.5, -0.5), glm::dvec3(63.5, 63.5, 63.5)};  // shows the half behind y = 31.5
  const Camera camera = camera_of(grid, Projection::Orthographic);
  View3D view(studio.renderer);
  const Image image = draw(view, scene, camera, kSize);
  const auto core = view.pick({100, 100}), shell = view.pick({100, 45});
  REQUIRE(core);
  REQUIRE(shell);
  CHECK(core->label == 3);
  CHECK(shell->label == 1);
  CHECK(core->normal == glm::dvec3(0));
  CHECK(core->point.y == doctest::Approx(31.5).epsilon(0.01));
  CHECK(glm::all(glm::lessThan(glm::abs(pixel_of(image, {100, 100}) - glm::ivec4(26, 26, 230, 255)),
                               glm::ivec4(3))));  // the colour (0.1, 0.1, 0.9) of label 3
}

TEST_CASE("view: a clip plane hides its normal's side") {
  Studio studio;
  const Grid grid = grid_of({64, 64, 64});
  Scene scene = scene_of(ball(grid, 26, 12));
  const Camera camera = camera_of(grid, Projection::Orthographic);
  View3D view(studio.renderer);
  const int whole = covered(draw(view, scene, camera, kSize));
  scene.clip.plane = {glm::dvec3(31.5), glm::dvec3(1, 0, 0)};
  CHECK(covered(draw(view, scene, camera, kSize)) == doctest::Approx(whole / 2.0).epsilon(0.03));
  CHECK(view.pick({90, 100}));
  CHECK_FALSE(view.pick({110, 100}));
  scene.clip.plane = {glm::dvec3(31.5), glm::normalize(glm::dvec3(0, -1, 0.3))};
  draw(view, scene, camera, kSize);
  CHECK(view.pick({100, 100})->label == 3);
}

TEST_CASE("view: in X-ray the bone shows through the flesh and is what is picked") {
  Studio studio;
  const Grid grid = grid_of({64, 64, 64});
  Scene scene = scene_of(ball(grid, 26, 12));
  scene.display = Display::XRay;
  const Camera camera = camera_of(grid);
  View3D view(studio.renderer);
  const Image image = draw(view, scene, camera, kSize);
  const glm::ivec4 middle = pixel_of(image, {100, 100}), beside = pixel_of(image, {100, 55});
  CHECK(middle.a == 255);
  CHECK(middle.b > middle.r);
  CHECK(beside.a > 15);
  CHECK(beside.a < 128);
  CHECK(view.pick({100, 100})->label == 3);
  CHECK(view.pick({100, 55})->label == 1);
}

TEST_CASE("view: in the tissue display each tissue has its own opacity") {
  Studio studio;
  const Grid grid = grid_of({64, 64, 64});
  auto looks = plain_looks();
  (*looks)[1].opacity = 0.25f;
  Scene scene = scene_of(ball(grid, 26, 12), looks);
  scene.display = Display::Tissue;
  const Camera camera = camera_of(grid);
  View3D view(studio.renderer);
  const Image image = draw(view, scene, camera, kSize);
  CHECK(pixel_of(image, {100, 100}).a == 255);
  CHECK(std::abs(pixel_of(image, {100, 55}).a - 64) <= 2);
}

TEST_CASE("view: the same scene gives the same picture, byte for byte, at once and refined") {
  Studio studio;
  const Grid grid = grid_of({50, 50, 50});
  const Scene scene = scene_of(lump(grid));
  const Camera camera = camera_of(grid);
  const auto refined = [&] {
    View3D view(studio.renderer);
    int calls = 0;
    for (double now = 0; !view.complete(); now += 0.05) {
      view.draw(scene, camera, kSize, now);
      REQUIRE(++calls < 1000);
    }
    return view.read();
  };
  CHECK(picture_of(studio.renderer, scene, camera, kSize).rgba ==
        picture_of(studio.renderer, scene, camera, kSize).rgba);
  const Image first = refined();
  CHECK(first.rgba == refined().rgba);
  CHECK(difference(first, picture_of(studio.renderer, scene, camera, kSize)).mean < 4);
}

TEST_CASE("view: a moving picture is refined only after a rest of 100 ms, a finished one stays as it is") {
  Studio studio;
  const Grid grid = grid_of({50, 50, 50});
  const Scene scene = scene_of(lump(grid));
  const Camera camera = camera_of(grid);
  View3D view(studio.renderer);
  view.draw(scene, camera, kSize, 10.0);
  CHECK_FALSE(view.complete());
  const Image coarse = view.read();
  view.draw(scene, camera, kSize, 10.05);
  CHECK(view.read().rgba == coarse.rgba);
  for (double now = 10.2; !view.complete(); now += 0.1) view.draw(scene, camera, kSize, now);
  CHECK(view.scale() == 1);
  const Image finished = view.read();
  view.draw(scene, camera, kSize, 60.0);
  CHECK(view.complete());
  CHECK(view.read().rgba == finished.rgba);

  // Hovering over a bone changes the picture, but does not restart the refinement of the body.
  Scene with_bones = scene;
  auto armature = std::make_shared<Armature>();
  armature->bones.push_back({.name = "Bone", .head = {10, 25, 10}, .tail = {40, 25, 40}});
  with_bones.armature = armature;
  view.draw(with_bones, camera, kSize, 61.0);
  CHECK(view.complete());
  CHECK(view.read().rgba != finished.rgba);
  view.draw(scene, orbited(camera, {10, 0}), kSize, 62.0);
  CHECK_FALSE(view.complete());
}

TEST_CASE("view: an empty volume, no volume, and an eye inside the body are drawn without harm") {
  Studio studio;
  const Grid grid = grid_of({40, 40, 40});
  const Camera camera = camera_of(grid);
  CHECK(covered(picture_of(studio.renderer, scene_of(painted(grid, [](const glm::dvec3&) { return Label{0}; })), camera,
                           kSize)) == 0);
  CHECK(covered(picture_of(studio.renderer, Scene{.grid = false, .transparent_background = true}, camera, kSize)) == 0);
  CHECK(covered(picture_of(studio.renderer,
                           scene_of(painted(grid_of({1, 1, 1}), [](const glm::dvec3&) { return Label{1}; })),
                           camera_of(grid_of({1, 1, 1})), kSize)) > 100);

  // The camera is inside a shell, so its inner wall fills the picture.
  const auto shell = painted(grid, [](const glm::dvec3& p) -> Label {
    const double r = glm::length(p - glm::dvec3(19.5));
    return r > 13 && r < 18 ? 2 : 0;
  });
  Camera inside = camera;
  inside.centre = glm::dvec3(19.5);
  inside.distance = 0.5;
  CHECK(covered(picture_of(studio.renderer, scene_of(shell), inside, kSize)) == kSize.x * kSize.y);
}

TEST_CASE("view: bones are picked where they are drawn, and a body in front dims them") {
  Studio studio;
  const Grid grid = grid_of({64, 64, 64});
  auto armature = std::make_shared<Armature>();
  armature->bones.push_back({.name = "Upper", .head = {31, 31, 60}, .tail = {31, 31, 36}});
  armature->bones.push_back({.name = "Lower", .parent = 0, .head = {31, 31, 36}, .tail = {55, 31, 20}});
  Scene scene = scene_of(ball(grid, 26));
  scene.armature = armature;
  const Camera camera = camera_of(grid, Projection::Orthographic);
  View3D view(studio.renderer);
  const Image behind = draw(view, scene, camera, kSize);
  glm::dvec2 pixel;
  REQUIRE(project(camera, {31, 31, 50}, kSize, pixel));
  CHECK(view.pick_bone(glm::ivec2(pixel)) == 0);
  REQUIRE(project(camera, {45, 31, 27}, kSize, pixel));
  CHECK(view.pick_bone(glm::ivec2(pixel)) == 1);
  CHECK_FALSE(view.pick_bone({5, 5}));

  Scene without = scene, in_front = scene;
  without.bone_shape = BoneShape::None;
  in_front.bones_in_front = true;
  const Image bare = draw(view, without, camera, kSize), over = draw(view, in_front, camera, kSize);
  CHECK(difference(bare, behind).mean > 0);
  CHECK(difference(bare, over).mean > 1.5 * difference(bare, behind).mean);
  CHECK_FALSE(view.pick_bone({-1, 300}));
}

TEST_CASE(
    "view: a cylinder is as wide at the head as at the tail, an octahedron is not, and either is picked at its rim") {
  Studio studio;
  auto armature = std::make_shared<Armature>();
  armature->bones.push_back({.name = "Bone", .head = {0, 0, 0}, .tail = {0, 0, 100}});
  Scene scene{.grid = false, .transparent_background = true};
  scene.armature = armature;
  const Camera camera = framing(looking_from(StandardView::Front, {}), {-20, -20, -10}, {20, 20, 110}, 1);
  View3D view(studio.renderer);
  glm::dvec2 head, tail;
  REQUIRE(project(camera, {0, 0, 0}, kSize, head));
  REQUIRE(project(camera, {0, 0, 100}, kSize, tail));
  const double length = glm::distance(head, tail);
  // Returns the number of pixels that the bone's drawing is wide at a point of its line.
  const auto width = [&](const Image& image, double t) {
    const int y = static_cast<int>(std::lround(glm::mix(head.y, tail.y, t)));
    int count = 0;
    for (int x = 0; x < kSize.x; ++x) count += image.rgba[(static_cast<size_t>(y) * kSize.x + x) * 4 + 3] > 0;
    return count;
  };
  scene.bone_shape = BoneShape::Cylinder;
  const Image cylinder = draw(view, scene, camera, kSize);
  CHECK(std::abs(width(cylinder, 0.2) - width(cylinder, 0.8)) <= 1);
  CHECK(width(cylinder, 0.5) == doctest::Approx(0.1 * length).epsilon(0.15));
  const glm::dvec2 rim = glm::mix(head, tail, 0.5) + glm::dvec2(0.05 * length + 3, 0);
  CHECK(view.pick_bone(glm::ivec2(rim)) == 0);
  CHECK_FALSE(view.pick_bone(glm::ivec2(rim + glm::dvec2(6, 0))));
  scene.bone_shape = BoneShape::Octahedron;
  const Image octahedron = draw(view, scene, camera, kSize);
  CHECK(width(octahedron, 0.2) > 3 * width(octahedron, 0.85));
}

TEST_CASE("view: at twice the scale bones' lines and joints are twice as wide, and picked as far beside") {
  Studio studio;
  auto armature = std::make_shared<Armature>();
  armature->bones.push_back({.name = "Bone", .head = {0, 0, 0}, .tail = {0, 0, 100}});
  Scene scene{.grid = false, .transparent_background = true};
  scene.armature = armature;
  scene.bone_shape = BoneShape::Stick;
  const Camera camera = framing(looking_from(StandardView::Front, {}), {-20, -20, -10}, {20, 20, 110}, 1);
  View3D view(studio.renderer);
  glm::dvec2 head, tail;
  REQUIRE(project(camera, {0, 0, 0}, kSize, head));
  REQUIRE(project(camera, {0, 0, 100}, kSize, tail));
  struct Seen {
    double line = 0, joint = 0;  // width in pixels of the bone at its middle and at its head
    int beside = 0;              // pixels from the line within which the bone is picked
  };
  const auto seen = [&](float scale) {
    scene.line_scale = scale;
    const Image image = draw(view, scene, camera, kSize);
    const auto width = [&](double y) {
      double sum = 0;
      for (int x = 0; x < kSize.x; ++x)
        sum += image.rgba[(static_cast<size_t>(std::lround(y)) * kSize.x + x) * 4 + 3] > 0;
      return sum;
    };
    const glm::ivec2 middle(glm::mix(head, tail, 0.5));
    Seen found{width(middle.y), width(head.y)};
    while (found.beside < 200 && view.pick_bone(middle + glm::ivec2(found.beside, 0))) ++found.beside;
    return found;
  };
  const Seen one = seen(1), two = seen(2);
  CHECK(std::abs(two.line - 2 * one.line) <= 2);
  CHECK(std::abs(two.joint - 2 * one.joint) <= 2);
  CHECK(std::abs(two.beside - 2 * one.beside) <= 2);
  CHECK(one.beside > 2);
}

TEST_CASE("view: all bones under a pixel are found, each with its depth") {
  Studio studio;
  auto armature = std::make_shared<Armature>();
  armature->bones.push_back({.name = "Far", .head = {0, 40, 0}, .tail = {0, 40, 100}});
  armature->bones.push_back({.name = "Near", .head = {0, -40, 0}, .tail = {0, -40, 100}});
  armature->bones.push_back({.name = "Beside", .head = {60, 0, 0}, .tail = {60, 0, 100}});
  Scene scene{.grid = false};
  scene.armature = armature;
  Camera camera = looking_from(StandardView::Front, {});
  camera.projection = Projection::Orthographic;
  camera = framing(camera, {-80, -80, -10}, {80, 80, 110}, 1);
  View3D view(studio.renderer);
  draw(view, scene, camera, kSize);
  glm::dvec2 pixel;
  REQUIRE(project(camera, {0, 0, 50}, kSize, pixel));
  const auto hits = view.pick_bones(glm::ivec2(pixel));
  REQUIRE(hits.size() == 2);
  CHECK(hits[0].bone == 0);
  CHECK(hits[1].bone == 1);
  CHECK(hits[0].depth - hits[1].depth == doctest::Approx(80));
}

TEST_CASE("view: a posed bone is drawn and picked where the pose puts it") {
  Studio studio;
  auto armature = std::make_shared<Armature>();
  armature->bones.push_back({.name = "Bone", .head = {0, 0, 0}, .tail = {0, 0, 40}});
  Scene scene{.grid = false, .transparent_background = true};
  scene.armature = armature;
  scene.posed_from_rest = {RigidTransform{.translation = {100, 0, 0}}};
  const Camera camera = framing(looking_from(StandardView::Front, {}), {-20, -20, -20}, {140, 20, 60}, 1);
  View3D view(studio.renderer);
  draw(view, scene, camera, kSize);
  glm::dvec2 rest, posed;
  REQUIRE(project(camera, {0, 0, 20}, kSize, rest));
  REQUIRE(project(camera, {100, 0, 20}, kSize, posed));
  CHECK_FALSE(view.pick_bone(glm::ivec2(rest)));
  CHECK(view.pick_bone(glm::ivec2(posed)) == 0);
}

TEST_CASE("view: the outline of a tissue follows its rim, in the colour of selection") {
  Studio studio;
  const Grid grid = grid_of({64, 64, 64});
  Scene scene = scene_of(ball(grid, 20));
  scene.outlined = Label{1};
  const Camera camera = camera_of(grid, Projection::Orthographic);
  View3D view(studio.renderer);
  const Image image = draw(view, scene, camera, kSize);
  int orange = 0;
  for (int y = 0; y < kSize.y; ++y)
    for (int x = 0; x < kSize.x; ++x) {
      const glm::ivec4 p = pixel_of(image, {x, y});
      orange += p.r > 230 && std::abs(p.g - 159) < 30 && p.b < 90;
    }
  CHECK(orange > 200);
  CHECK(pixel_of(image, {100, 100}).g < 100);
}

TEST_CASE("view: every OpenGL object is gone with the views and the renderer") {
  REQUIRE(gl::live_objects() == 0);
  {
    Studio studio;
    const Grid grid = grid_of({40, 40, 40});
    Scene scene = scene_of(ball(grid, 15, 6));
    scene.display = Display::XRay;
    View3D view(studio.renderer);
    SliceView slice(studio.renderer);
    for (double now = 0; !view.complete(); now += 1) view.draw(scene, camera_of(grid), kSize, now);
    slice.draw(scene, {.centre = glm::dvec3(20)}, SliceDisplay::Labels, kSize);
    CHECK(gl::live_objects() > 0);
    const int before = gl::live_objects();
    for (int i = 0; i < 3; ++i) {  // an unused volume is freed when the next one is uploaded
      Scene next = scene_of(ball(grid, 10 + i));
      draw(view, next, camera_of(grid), kSize);
    }
    CHECK(gl::live_objects() < before + 12);
  }
  CHECK(gl::live_objects() == 0);
}
