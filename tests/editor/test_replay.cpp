// SPDX-License-Identifier: AGPL-3.0-or-later
// Plays scripts in the real editor, without a display.
#include <cmath>
#include <cstdio>
#include <sstream>

#include <epoxy/gl.h>

#include "core/base/error.h"
#include "editor/context/frame_timing.h"
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/screen.h"
#include "editor/ui/ui.h"
#include "render/gl/object.h"
#include "render/image_io.h"
#include "tests/editor/small_clip.h"
#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::test;

TEST_CASE("replay: menus, keys and buttons lead to the same operators") {
  SmallEditor test;
  test.play(R"(
    expect layout one
    click view.four
    expect layout four
    click "View/3D and slices"
    expect layout split
    key Ctrl+Alt+Q
    expect layout four
    click view.xray_display
    expect display xray
    key Alt+Z
    expect display solid
    click "View/Display/Tissue"
    expect display tissue
    key Ctrl+3
    expect workspace pose
    expect layout one
    key Ctrl+PageDown
    expect workspace resample
    click top/Rig
    expect workspace rig
    expect layout four
  )");
}

TEST_CASE("replay: a key pressed and released between two frames is not lost") {
  SmallEditor test;
  for (int i = 0; i < 5; ++i)
    for (const bool down : {true, false}) test.host->events.push(editor::KeyChanged{editor::Key::T, down});
  test.player.settle();
  CHECK(test.fact("strip") == "no");  // the key T, which shows or hides the strip, was pressed five times
}

TEST_CASE("replay: clicks faster than frames all arrive") {
  SmallEditor test({1280, 720});
  const editor::Widget* eye = test.editor->ui->widgets.find("Muscle/17/eye");
  REQUIRE(eye);
  test.host->events.push(editor::PointerMoved{eye->rect.centre()});
  for (int i = 0; i < 7; ++i)
    for (const bool down : {true, false})
      test.host->events.push(editor::ButtonChanged{editor::MouseButton::Left, down});
  test.player.settle();
  CHECK(test.fact("hidden") == "1");
  CHECK(test.fact("history") == "8");
}

TEST_CASE("replay: tissues are hidden, shown alone and revealed, and each edit is undone and redone") {
  SmallEditor test({1280, 720});
  const std::string first = test.fact("document");
  test.play(R"(
    click Muscle/17/eye
    expect hidden 1
    expect edit "Hide Muscle"
    click Muscle/17/eye Ctrl
    expect hidden 3
    click Blood/65/name
    expect tissue 65
    click Skin/143/name Ctrl
    expect selected 2
    key Alt+H
    expect hidden 0
    key H
    expect hidden 2
    key Shift+H
    expect edit "Show only 2 tissues"
    expect position 5
    key Ctrl+Z
    key Ctrl+Z
    key Ctrl+Z
    key Ctrl+Z
    key Ctrl+Z
    expect position 0
    expect hidden 0
  )");
  CHECK(test.fact("document") != "");
  const std::string undone = editor::document_hash(test.editor->document());
  CHECK(undone == first);
  test.play("key Ctrl+Shift+Z\n key Ctrl+Y\n expect position 2\n expect hidden 3");
}

TEST_CASE("replay: the 3D view turns, shifts and zooms with Blender's keys") {
  SmallEditor test;
  const auto camera = [&]() -> const render::Camera& { return test.editor->views->body.camera; };
  const render::Camera first = camera();
  test.play("drag \"3D view/view\" 60 20 MMB");
  CHECK(camera().world_from_view != first.world_from_view);
  CHECK(camera().centre == first.centre);
  const render::Camera turned = camera();
  test.play("drag \"3D view/view\" 60 20 MMB Shift");
  CHECK(camera().world_from_view == turned.world_from_view);
  CHECK(camera().centre != turned.centre);
  const double distance = camera().distance;
  test.play("drag \"3D view/view\" 0 40 MMB Ctrl");
  CHECK(camera().distance > distance);
  test.play("wheel \"3D view/view\" 3");
  CHECK(camera().distance < distance * 1.2);
  test.play(
      "key Num1\n wait 0.3\n expect view Front\n key Ctrl+Num3\n wait 0.3\n expect view Right\n key Num5\n expect "
      "projection parallel");
  const render::Camera right = camera();
  test.play("drag \"3D view/view\" 40 0 LMB Alt");
  CHECK(camera().world_from_view != right.world_from_view);
  test.play("key Num7\n wait 0.05");
  CHECK(test.editor->views->body.move);
  test.play("key Home");
  test.play("wait 0.3\n expect view Top");
}

TEST_CASE("replay: any input ends the move of a camera") {
  SmallEditor test;
  test.play("key Num3\n wait 0.05");
  REQUIRE(test.editor->views->body.move);
  test.play("wheel \"3D view/view\" 1");
  CHECK_FALSE(test.editor->views->body.move);
}

TEST_CASE("replay: Escape drops a drag") {
  SmallEditor test;
  test.host->events.push(editor::PointerMoved{test.editor->ui->widgets.find("3D view/view")->rect.centre()});
  test.host->events.push(editor::ButtonChanged{editor::MouseButton::Middle, true});
  test.player.settle();
  CHECK(test.editor->interaction->drag);
  test.play("key Escape");
  CHECK_FALSE(test.editor->interaction->drag);
}

TEST_CASE("replay: slices step, zoom about the pointer, shift, and meet in the cross-hair") {
  SmallEditor test({1280, 720});
  test.play("click view.four\n move Axial/view");
  const double z = test.editor->views->cross_hair.z;
  test.play("wheel Axial/view 1");
  CHECK(std::abs(test.editor->views->cross_hair.z - z) == doctest::Approx(3).epsilon(0.6));
  const double stepped = test.editor->views->cross_hair.z;
  test.play("wheel Axial/view 1 Shift");
  CHECK(test.editor->views->cross_hair.z == doctest::Approx(stepped + 15));
  test.play("wheel Axial/view -1 Shift\n key PageDown");
  CHECK(test.editor->views->cross_hair.z == doctest::Approx(stepped - 3));
  const double scale = test.editor->views->slices[2].camera.millimetres_per_pixel;
  test.play("wheel Axial/view 2 Ctrl");
  CHECK(test.editor->views->slices[2].camera.millimetres_per_pixel == doctest::Approx(scale / 1.44));
  const glm::dvec3 centre = test.editor->views->slices[1].camera.centre;
  test.play("drag Coronal/view 30 0 MMB");
  CHECK(test.editor->views->slices[1].camera.centre.x ==
        doctest::Approx(centre.x - 30 * test.editor->views->slices[1].camera.millimetres_per_pixel));
  test.play("click tool.cross_hair\n drag Coronal/view 20 0");
  CHECK(test.editor->views->cross_hair.x > centre.x - 30 * test.editor->views->slices[1].camera.millimetres_per_pixel);
  test.play("key O\n expect slices outline");
}

TEST_CASE("replay: what the pointer is over is named, in the body and in slices") {
  SmallEditor test({1280, 720});
  test.play("wait-idle\n move \"3D view/view\"\n expect \"text:Skin\"");
  CHECK(test.editor->views->hover.inside);
  CHECK(test.editor->views->hover.label == 143);
  test.play("click view.four\n wait-idle\n move Axial/view");
  CHECK(test.editor->views->hover.label == 111);
}

TEST_CASE("replay: clip box and clip plane are edits like any other") {
  SmallEditor test;
  test.play(R"(
    key Alt+B
    expect clip-box yes
    key Shift+Alt+B
    expect clip-plane yes
    click "View/Clipping/Reset clipping"
    expect clip-box no
    key Ctrl+Z
    expect clip-box yes
    expect clip-plane yes
  )");
}

TEST_CASE("replay: splitters follow the pointer, and a double click restores them") {
  SmallEditor test({1280, 720});
  const float before = test.editor->screen->layout.sidebar.width();
  test.play("drag \"splitter sidebar/grip\" -60 0");
  CHECK(test.editor->screen->layout.sidebar.width() == doctest::Approx(before + 60).epsilon(0.02));
  test.play("double-click \"splitter sidebar/grip\"");
  CHECK(test.editor->screen->layout.sidebar.width() == before);
  // The pointer rests on the splitter before it is dragged.
  test.play("click view.four\n move \"splitter four-y/grip\"\n wait 0.5\n wait-idle");
  test.play("click view.four\n drag \"splitter four-y/grip\" 0 50");
  CHECK(test.editor->screen->arrangement().four_y > 0.55f);
  test.play("key Ctrl+2\n key Ctrl+1");
  CHECK(test.editor->screen->arrangement().four_y > 0.55f);  // each workspace stores its own position of the splitter
}

TEST_CASE("replay: the area under the pointer is maximized and shrinks back") {
  SmallEditor test({1280, 720});
  test.play(
      "click view.four\n move Coronal/view\n key Ctrl+Space\n expect maximized Coronal\n key Ctrl+Space\n expect "
      "maximized no\n expect layout four");
}

TEST_CASE("replay: the same script gives the same document and the same picture") {
  const char* script = R"(
    click Muscle/17/eye
    key Alt+B
    drag "3D view/view" 80 30 MMB
    click view.four
    wheel Axial/view 2
    click Skin/143/name
    wait-idle
  )";
  std::string hash[2];
  render::Image picture[2];
  for (int i = 0; i < 2; ++i) {
    SmallEditor test({1280, 720});
    test.draw_finely();
    test.play(script);
    hash[i] = test.fact("document");
    picture[i] = test.host->picture();
  }
  CHECK(hash[0] == hash[1]);
  REQUIRE(picture[0].size == picture[1].size);
  std::int64_t different = 0;
  for (std::size_t i = 0; i < picture[0].rgba.size(); ++i)
    different += std::abs(picture[0].rgba[i] - picture[1].rgba[i]) > 4;
  CHECK(different < std::ssize(picture[0].rgba) / 1000);
}

TEST_CASE("replay: a volume opens in the background while the editor goes on, and what cannot be read is told") {
  TemporaryFolder folder;
  const Document body = small_body();
  write_volume(*body.volume, folder / "ball.nrrd", *body.tissues);
  SmallEditor test({1024, 640}, {}, false);
  const std::vector<editor::ViewPlace> before = test.editor->screen->layout.view_places;
  test.editor->project->to_open = {folder / "ball.nrrd"};
  test.player.step();
  CHECK(test.editor->screen->layout.view_places[0].rect == before[0].rect);  // the layout does not change for a job
  test.play("wait-job\n expect volume yes\n expect name ball");
  CHECK(*test.editor->document().volume->voxels.data() == 0);
  CHECK(test.editor->document().volume->voxels == body.volume->voxels);
  test.host->events.push(editor::FilesDropped{{folder / "missing.nrrd"}});
  test.play("wait-job\n expect volume yes\n expect error \"There is no such file\"");
}

TEST_CASE("replay: named widgets lie in their regions and none covers another") {
  for (const auto& [size, scale] :
       {std::pair{glm::ivec2(1600, 900), 1.0}, {glm::ivec2(1024, 640), 1.0}, {glm::ivec2(2048, 1280), 2.0}}) {
    SmallEditor test(size, {.scale = scale});
    for (const char* arrangement : {"click view.one", "click view.four", "click view.split\n click \"Help/Console\""}) {
      test.play(arrangement);
      const editor::Layout& layout = test.editor->screen->layout;
      const auto region_of = [&](editor::Region region) {
        switch (region) {
          case editor::Region::TopBar: return layout.top_bar;
          case editor::Region::ToolHeader: return layout.tool_header;
          case editor::Region::ToolStrip: return layout.tool_strip;
          case editor::Region::Sidebar: return layout.sidebar.empty() ? layout.sidebar_handle : layout.sidebar;
          case editor::Region::Bottom: return layout.bottom;
          case editor::Region::Status: return layout.status;
          default: return layout.window;
        }
      };
      const auto& widgets = test.editor->ui->widgets.widgets();
      CHECK(widgets.size() > 15);
      for (std::size_t i = 0; i < widgets.size(); ++i) {
        INFO(size.x, "x", size.y, ": ", widgets[i].name);
        CHECK(region_of(widgets[i].region).contains(widgets[i].rect));
        for (std::size_t k = 0; k < i; ++k) {
          if (widgets[i].region != widgets[k].region || widgets[i].name.ends_with("/view") ||
              widgets[k].name.ends_with("/view"))
            continue;
          if (widgets[i].name.ends_with("/grip") || widgets[k].name.ends_with("/grip")) continue;
          INFO("and ", widgets[k].name);
          CHECK_FALSE(widgets[i].rect.overlaps(widgets[k].rect));
        }
      }
    }
  }
}

TEST_CASE("replay: an editor at rest draws nothing and leaves no OpenGL error, closed, no OpenGL object") {
  {
    SmallEditor test;
    test.play("wait-idle\n click view.four\n wait 1\n wait-idle");  // waits until the button's tooltip is shown
    CHECK(test.editor->rest() > 1);
    CHECK(glGetError() == GL_NO_ERROR);
    CHECK(render::gl::live_objects() > 0);
    test.editor.reset();
    CHECK(glGetError() == GL_NO_ERROR);
    CHECK(render::gl::live_objects() == 0);
  }
}

TEST_CASE("replay: every operator that can run without more words does, and leaves the editor alive") {
  SmallEditor test({1024, 640});
  for (const editor::Operator& op : editor::gather_operators()) {
    if (op.id == "file.quit" || op.label.ends_with("...")) continue;
    INFO(op.id);
    run(*test.editor, op.id);
    test.play("key Escape");
    CHECK(test.fact("error") == "none");
    test.editor->interaction->drag.reset();
  }
}

TEST_CASE("replay: while a number is typed its field shows digits alone, and no tip covers what is below") {
  SmallEditor test({1280, 720});
  test.editor->history->reset(bending_limb(), "Open limb");
  test.play("key Ctrl+3\nwait-idle\nmove view.four\nwait 2");
  CHECK(test.editor->ui->tip.widget == "Four views");  // no field has the keyboard, so tips are shown
  CHECK(test.fact("text:Four views") == "shown");
  test.play("click \"Motion/Onion skin and paths/Onion frames...\"\nwait-idle\nmove \"Ghosts per side/value\"\nwait 2");
  CHECK(test.editor->ui->tip.widget.empty());  // this dialog's first field has the keyboard, so none is shown
  const editor::Rect field = test.editor->ui->widgets.find("Ghosts per side/value")->rect;
  const auto beside = [&] {
    const render::Image picture = test.host->picture();
    std::vector<std::uint8_t> pixels;
    for (int y = static_cast<int>(field.low.y); y < static_cast<int>(field.high.y); ++y) {
      const auto at = picture.rgba.begin() +
                      4 * (static_cast<std::ptrdiff_t>(y) * picture.size.x + static_cast<int>(field.high.x) + 1);
      pixels.insert(pixels.end(), at, at + 4 * 14);
    }
    return pixels;
  };
  const auto before = beside();
  test.play("double-click \"Ghosts per side/value\"\ntype 7\nwait 2");
  CHECK(test.editor->ui->tip.widget.empty());
  CHECK(beside() == before);
  test.play("key Return\nwait-idle");
  CHECK(test.editor->timeline->onion.count == 7);
}

TEST_CASE("replay: a script tells what its frames cost, and what a clip that plays looks like") {
  SmallEditor test;
  test.editor->history->reset(bending_limb(), "Open limb");
  const TemporaryFolder folder;
  const auto file = [&](const char* name) { return (folder / name).string(); };
  test.play("key Ctrl+3\nwait-idle\nframe-log " + file("before") +
            "\nmove \"3D view/view\"\nkey Space\nwait 0.5\nexpect playing yes\nshot " + file("a.png") + "\nshot-now " +
            file("b.png") + "\nwait 0.5\nexpect playing yes\nframe-log " + file("log") + "\nframe-log " +
            file("empty"));
  CHECK(render::read_png(file("a.png")).rgba == render::read_png(file("b.png")).rgba);
  CHECK_THROWS_WITH_AS(test.play("wait-idle"), doctest::Contains("while a clip plays"), Error);
  std::istringstream log(read_file(file("log")));
  int frames = 0, waited = 0;
  double worst = 0;
  for (std::string line; std::getline(log, line);) {
    if (line[0] == '#') continue;
    const double took = std::stod(line.substr(line.find('\t') + 1));
    worst = std::max(worst, took);
    CHECK(std::stoi(line) == ++frames);
    waited += line.find("wait 0.5") != std::string::npos;
  }
  CHECK(std::abs(waited - 60) <= 2);  // both waits of half a second, at 60 frames a second
  const std::string text = read_file(file("log")), head = "# ms: worst ";
  const std::size_t said = text.find(head);
  CHECK(text.starts_with("# " + std::to_string(frames) + " frames\n"));
  REQUIRE(said != std::string::npos);
  CHECK(std::abs(std::stod(text.substr(said + head.size())) - worst) < 0.06);  // both values are rounded
  CHECK(read_file(file("empty")).starts_with("# 0 frames\n"));
}

TEST_CASE("frame log: a percentile is the value that so many do not exceed") {
  std::vector<double> values;
  for (int i = 100; i > 0; --i) values.push_back(i);
  CHECK(editor::percentile(values, 95) == 95);
  CHECK(editor::percentile(values, 100) == 100);
  CHECK(editor::percentile({3}, 50) == 3);
  CHECK(editor::percentile({}, 50) == 0);
}

TEST_CASE("script: a wrong line is named") {
  SmallEditor test;
  CHECK_THROWS_WITH_AS(test.play("key Ctrl+1\nclick Nowhere"), doctest::Contains("line 2"), Error);
  CHECK_THROWS_WITH_AS(test.play("expect workspace skin"), doctest::Contains("it is 'rig'"), Error);
  CHECK_THROWS_WITH_AS(test.play("type \"no end"), doctest::Contains("line 1"), Error);
}

TEST_CASE("script: a number that no window or hand reaches is refused, and nothing waits for ever") {
  SmallEditor test;
  for (const char* line :
       {"wait nan", "wait inf", "wait 1e308", "wait -1", "resize 0 500", "resize 1e9 500", "resize nan 500",
        "move 1e308 0", "wheel \"3D view/view\" 1e9", "drag \"3D view/view\" inf 0"})
    CHECK_THROWS_WITH_AS(test.play(line), doctest::Contains("a number from"), Error);
}

TEST_CASE("replay: a face of the clip box follows its handle, shown while dragged, one edit at the end") {
  SmallEditor test;
  test.play("key Num1\n wait 0.3\n key Alt+B\n wait-idle");
  const auto box = [&] { return test.editor->document().visibility->clip_box; };
  const ClipBox before = box();
  REQUIRE(test.editor->ui->widgets.find("Clip face z+"));
  const int steps = static_cast<int>(test.editor->history->steps().size());
  test.play("press \"Clip face z+\"");
  const glm::vec2 at = test.editor->ui->input.pointer;
  for (int i = 1; i <= 5; ++i) {
    test.host->events.push(editor::PointerMoved{at + glm::vec2(0, 12.0f * i)});
    test.player.settle();
  }
  CHECK(box() == before);  // still a preview, no edit
  REQUIRE(test.editor->views->preview_visibility);
  CHECK(test.editor->views->preview_visibility->clip_box.high.z < before.high.z);
  test.play("release\n expect edit \"Move clip box\"");
  CHECK(box().high.z < before.high.z);
  CHECK(box().low == before.low);
  CHECK(test.editor->history->steps().size() == steps + 1u);
  // The face follows the pointer to within a voxel.
  glm::dvec2 pixel;
  const AffineTransform world = world_from_voxel(test.editor->document().volume->grid);
  glm::dvec3 face = (box().low + box().high) * 0.5;
  face.z = box().high.z;
  REQUIRE(render::project(test.editor->views->body.camera, world * face,
                          glm::ivec2(test.editor->screen->layout.views.size()), pixel));
  CHECK(std::abs(pixel.y + test.editor->screen->layout.views.low.y - (at.y + 60)) < 10);
  test.play("key Ctrl+Z");
  CHECK(box() == before);
  test.play("press \"Clip face z+\"");
  test.host->events.push(editor::PointerMoved{at + glm::vec2(0, 60)});
  test.play("key Escape\n release");
  CHECK(box() == before);
}

TEST_CASE("replay: a handle or button in a view keeps the press to itself") {
  SmallEditor test;
  test.play("wait-idle\n click \"axis S\"\n wait 0.3\n expect view Top\n expect selected 0");
}

TEST_CASE("replay: opacity is dragged live and is one edit") {
  SmallEditor test({1280, 720});
  test.play("drag Muscle/17/opacity -15 0\n expect edit \"Set opacity of Muscle\"\n expect history 2");
  CHECK(test.editor->document().visibility->looks.at(17).opacity < 0.5f);
  CHECK_FALSE(test.editor->views->preview_visibility);
}

TEST_CASE("replay: the right button chooses what it lists commands for") {
  SmallEditor test({1280, 720});
  test.play(
      "wait-idle\n right-click \"3D view/view\"\n expect tissue 143\n expect \"widget:context/Hide\"\n click "
      "context/Hide\n expect hidden 1\n expect edit \"Hide Skin\"");
}

TEST_CASE("replay: Alt and a click choose, and list what lies behind") {
  SmallEditor test({1280, 720});
  test.play(
      "wait-idle\n click \"3D view/view\" Alt\n expect tissue 143\n expect \"widget:pick/Muscle\"\n click "
      "pick/Muscle\n expect tissue 17");
}

TEST_CASE("replay: labels of the header's switches go before a choice goes behind three dots") {
  SmallEditor test({1280, 720});
  test.editor->history->reset(bending_limb(), "Open limb");
  test.play("key Ctrl+1\nwait-idle\nexpect widget:header/Snap\nexpect widget:header/Axes\nexpect text:Templates");
}

TEST_CASE("replay: what does not fit the header goes behind three dots") {
  SmallEditor test({1200, 640});
  test.play(
      "click view.four\n drag \"splitter sidebar/grip\" -240 0\n expect \"widget:header/More\"\n click header/More\n "
      "click \"more/Clip plane\"\n expect clip-plane yes");
  // The menu must not cover the buttons beside it: it opens below the tool header and within the window.
  test.play("click header/More\n wait 1");
  const editor::Rect entry = test.editor->ui->widgets.find("more/Clip plane")->rect;
  CHECK(entry.low.y > test.editor->screen->layout.tool_header.high.y);
  CHECK(entry.high.x <= test.editor->screen->layout.window.high.x);
  CHECK(entry.low.x >= 0);
}

TEST_CASE("replay: the cross-hair starts inside the body, and slices show all of it whichever layout comes first") {
  SmallEditor test({1280, 720});
  const LabelVolume& volume = *test.editor->document().volume;
  CHECK(volume.at(glm::ivec3(glm::round(voxel_from_world(volume.grid) * test.editor->views->cross_hair))) != 0);
  test.play("click view.four");
  for (const editor::ViewId id : {editor::ViewId::Axial, editor::ViewId::Coronal, editor::ViewId::Sagittal}) {
    const glm::vec2 size = test.editor->screen->layout.place_of(id)->size();
    for (const double side : {-40.0, 40.0}) {
      const glm::vec2 pixel =
          editor::pixel_of(editor::slice_of(*test.editor->views, id).camera, glm::dvec3(side), size);
      CHECK(editor::Rect{{0, 0}, size}.contains(pixel));
    }
  }
}

TEST_CASE("replay: menus at the pointer list views, displays and workspaces") {
  SmallEditor test({1024, 640});
  test.play(R"(
    move "3D view/view"
    key Z
    click Display/X-ray
    expect display xray
    key `
    click Views/Top
    wait 0.3
    expect view Top
    key Ctrl+Tab
    click Workspaces/Pose
    expect workspace pose
  )");
}

TEST_CASE("replay: Escape closes menus") {
  SmallEditor test({1024, 640});
  test.play(R"(
    click View/Overlays
    expect widget:Overlays/Grid
    key Escape
    expect widget:Overlays/Grid absent
    expect widget:View/Sidebar absent
    move "3D view/view"
    key Z
    expect widget:Display/Solid
    key Escape
    expect widget:Display/Solid absent
  )");
}

TEST_CASE("replay: tissues without a name are listed by their label") {
  TemporaryFolder folder;
  LabelVolume volume = *small_body().volume;
  for (Label& label : volume.voxels) label += label ? 1000 : 0;  // labels that no built-in table names
  write_volume(volume, folder / "ball.mha");
  SmallEditor test({1600, 900}, {}, false);
  test.editor->project->to_open = {folder / "ball.mha"};
  test.play("wait-job\n wait-idle\n expect volume yes\n expect \"text:Label 1017\"");
}
