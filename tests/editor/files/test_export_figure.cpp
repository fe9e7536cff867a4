// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/files/export_figure.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/volume/grey_levels.h"
#include "editor/figure/figure_source.h"
#include "editor/files/export.h"
#include "editor/files/picture_task.h"
#include "render/image_io.h"
#include "tests/editor/small_editor.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

std::string exported(SmallEditor& test, const FigureOptions& options, const Path& path) {
  export_figure(*test.editor, options, path);
  test.play("wait-job\n wait-idle");
  return read_file(path);
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("export figure: it shows the active view, and says where its scale holds") {
  SmallEditor test;
  const TemporaryFolder folder;
  Views& views = *test.editor->views;
  const FigureOptions options{.size = {60, 50}, .dots_per_inch = 100, .letter = "c", .title = "A ball"};
  const std::string perspective = exported(test, options, folder / "perspective.svg");
  CHECK(has(perspective, "at the focus"));
  CHECK(has(perspective, ">A ball</text>"));
  CHECK(has(perspective, ">c</text>"));
  views.body.camera.projection = render::Projection::Orthographic;
  CHECK_FALSE(has(exported(test, options, folder / "parallel.svg"), "at the focus"));
  test.play("key Ctrl+Alt+Q\n wait-idle");
  views.active = ViewId::Axial;
  const std::string slice = exported(test, options, folder / "slice.svg");
  CHECK(has(slice, " mm</text>"));
  CHECK_FALSE(has(slice, "at the focus"));
  CHECK(slice != perspective);
}

TEST_CASE("export figure: PNG and TIFF are written with the editor staying responsive, other names are refused") {
  SmallEditor test;
  const TemporaryFolder folder;
  const FigureOptions options{.size = {40, 30}, .dots_per_inch = 127};
  exported(test, options, folder / "figure.png");
  CHECK(render::read_png(folder / "figure.png").size == glm::ivec2(200, 150));
  CHECK(exported(test, options, folder / "figure.tif").starts_with("II*"));
  CHECK_THROWS_AS(export_figure(*test.editor, options, folder / "figure.bmp"), Error);
  CHECK_THROWS_AS(export_figure(*test.editor, options, folder / "nowhere" / "figure.png"), Error);
}

TEST_CASE("export figure: lines are as wide on the page as on a screen, whatever the resolution") {
  FigureLayout layout;
  const auto points = [&](double dots, int height) {
    layout.options.dots_per_inch = dots;
    layout.picture_pixels = {height, height};
    return figure_line_scale(layout) / dots * 72;
  };
  for (const double dots : {100.0, 300.0, 1200.0})
    for (const int height : {100, 700, 3000, 8000}) {
      CHECK(points(dots, height) >= 0.2499);
      CHECK(points(dots, height) <= 0.7501);
    }
  CHECK(points(300, 1400) == doctest::Approx(points(600, 2800)));
}

TEST_CASE("export figure: its lines do not depend on how large the editor draws its own") {
  SmallEditor test;
  const TemporaryFolder folder;
  auto armature = std::make_shared<Armature>();
  armature->bones.push_back({.name = "Bone", .head = {0, 0, -40}, .tail = {0, 0, 40}});
  render::Scene& scene = test.editor->views->scene;
  const auto drawn = [&](const char* name, float scale) {
    scene.armature = armature;
    scene.bone_shape = render::BoneShape::Stick;
    scene.bones_in_front = true;
    scene.line_scale = scale;
    return exported(test, {.size = {40, 30}, .dots_per_inch = 200}, folder / name);
  };
  const std::string small = drawn("small.png", 1), large = drawn("large.png", 4);
  CHECK(small == large);
  armature.reset();
  CHECK(drawn("bare.png", 1) != small);
}

TEST_CASE("export figure: a slice is written with its whole image, and its legend lists what the image leaves seen") {
  SmallEditor test;
  const TemporaryFolder folder;
  test.play("key Ctrl+Alt+Q\n wait-idle");
  Views& views = *test.editor->views;
  views.active = ViewId::Axial;
  const auto legend = [&](float opacity, render::SliceDisplay display, const char* name) {
    Grid grid = test.editor->document().volume->grid;
    grid.size = {256, 256, 128};
    const std::vector<float> values(static_cast<std::size_t>(grid.voxel_count()), 100.0f);
    views.scene.grey =
        render::ShownGrey{.image = std::make_shared<const GreyLevels>(grey_levels(grid, values)), .tissues = opacity};
    views.slice_display = display;
    views.renderer.begin_frame(0);  // the view may spend no time in this frame
    const std::string svg = exported(test, {.size = {60, 50}, .dots_per_inch = 100}, folder / name);
    CHECK(has(svg, " mm</text>"));
    return has(svg, ">Muscle</text>");
  };
  CHECK(legend(0.35f, render::SliceDisplay::Labels, "both.svg"));
  CHECK_FALSE(legend(0, render::SliceDisplay::Labels, "image.svg"));
  CHECK(legend(0, render::SliceDisplay::Outline, "outlines.svg"));
}

TEST_CASE("export figure: the legend of a large figure is that of a picture of a million pixels") {
  SmallEditor test;
  Views& views = *test.editor->views;
  glm::ivec2 asked(0);
  const SliceCameraAt camera = [&](const glm::ivec2& size) {
    asked = size;
    return render::SliceCamera{.axis = render::SliceAxis::Axial, .millimetres_per_pixel = 120.0 / size.x};
  };
  const FigureSource source =
      slice_source(views.scene, camera, render::SliceDisplay::Labels, test.editor->document().tissues);
  const std::vector<LegendEntry> large = source.legend({8000, 4000});
  CHECK(asked.x * asked.y <= 1'000'000);
  CHECK(asked.x == doctest::Approx(2 * asked.y).epsilon(0.01));
  REQUIRE(large.size() == 4);
  CHECK(large[0].name == "Muscle");
  CHECK(large == source.legend({800, 400}));
  CHECK(asked == glm::ivec2(800, 400));
}

TEST_CASE("export picture: cancelled before its job began, it ends, and while it waits the editor is at rest") {
  SmallEditor test({320, 240});
  Editor& editor = *test.editor;
  editor.jobs->set_at_once(0);
  bool taken = false;
  start_picture_task(editor, {.label = "Export three pictures",
                              .scene = editor.views->scene,
                              .size = {64, 48},
                              .pictures = 3,
                              .camera = [camera = editor.views->body.camera](int) { return camera; },
                              .take = [&](int, const render::Image&, Progress&) { taken = true; },
                              .finish = [](Progress&) -> Finish { return {}; }});
  for (int i = 0; i < 100 && editor.rest() == 0; ++i) test.player.step();
  CHECK(editor.rest() > 0);
  CHECK(editor.background->each_frame.size() == 1);
  editor.jobs->cancel_all();
  for (int i = 0; i < 10; ++i) test.player.step();
  CHECK(editor.background->each_frame.empty());
  CHECK(editor.at_rest());
  CHECK_FALSE(taken);
}

TEST_CASE("export picture: what OpenGL cannot draw fails the job with its message, and the editor lives on") {
  SmallEditor test({320, 240});
  Editor& editor = *test.editor;
  bool taken = false;
  start_picture_task(editor, {.label = "Export wide.png",
                              .scene = editor.views->scene,
                              .size = {200000, 8},
                              .camera = [camera = editor.views->body.camera](int) { return camera; },
                              .take = [&](int, const render::Image&, Progress&) { taken = true; },
                              .finish = [](Progress&) -> Finish { return {}; }});
  test.play("wait-job\n wait-idle");
  CHECK_FALSE(taken);
  CHECK(editor.background->each_frame.empty());
  CHECK(test.fact("error") == "The graphics driver reports an invalid value");
  const TemporaryFolder folder;
  editor.messages->errors.clear();
  export_picture(editor, folder / "picture.png");
  test.play("wait-job");
  CHECK(std::filesystem::exists(folder / "picture.png"));
}

TEST_CASE(
    "export turntable: a name that ends in .mp4 makes a video where ffmpeg is, and an error in one line elsewhere") {
  SmallEditor test({640, 480});
  const TemporaryFolder folder;
  const Path path = folder / "turn.mp4";
  if (!has_program("ffmpeg")) {
    CHECK_THROWS_WITH_AS(export_turntable(*test.editor, path), doctest::Contains("ffmpeg, which is not installed"),
                         Error);
    CHECK_FALSE(std::filesystem::exists(path));
    return;
  }
  export_turntable(*test.editor, path);
  test.play("wait-job");
  REQUIRE(std::filesystem::exists(path));
  CHECK(read_file(path).substr(4, 4) == "ftyp");
  CHECK(test.fact("error") == "none");
}
