// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the clip box and the clip plane, which are set by dragging handles and by typing numbers.
#include <fstream>

#include "editor/files/export.h"
#include "editor/viewport/clipping_gizmo.h"
#include "tests/editor/small_editor.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

const ClipBox& box_of(const SmallEditor& test) { return test.editor->document().visibility->clip_box; }

}  // namespace

TEST_CASE("clip box: faces stay within the grid and off one another") {
  const Document body = small_body();
  ClipBox box{true, glm::dvec3(-0.5), glm::dvec3(body.volume->grid.size) - 0.5};
  move_face(box, body.volume->grid, 0, true, 1e9);
  CHECK(box.high.x == 23.5);
  move_face(box, body.volume->grid, 0, true, -1e9);
  CHECK(box.high.x == 0.5);
  move_face(box, body.volume->grid, 0, false, 1e9);
  CHECK(box.low.x == -0.5);
}

TEST_CASE("replay: with Ctrl a face of the clip box goes by whole centimetres, and a double click brings it back") {
  SmallEditor test({1280, 720});
  test.play("key Num1\n wait 0.3\n key Alt+B\n drag \"Clip face z+\" 0 100 LMB Ctrl");
  const Grid& grid = test.editor->document().volume->grid;
  const double place = (world_from_voxel(grid) * glm::dvec3(0, 0, box_of(test).high.z)).z;
  CHECK(place < (world_from_voxel(grid) * glm::dvec3(0, 0, grid.size.z - 0.5)).z - 5);
  CHECK(std::abs(std::remainder(place, 10)) < 1e-6);
  test.play("double-click \"Clip face z+\"\n expect edit \"Reset clip face\"");
  CHECK(box_of(test).high.z == grid.size.z - 0.5);
}

TEST_CASE(
    "replay: a face of the clip box at the volume's end hides nothing of a body that is posed beyond it, one that was "
    "moved does") {
  SmallEditor test({1280, 720});
  test.play("key Num1\n wait 0.3\n key Alt+B");
  const glm::dvec3 last = glm::dvec3(test.editor->document().volume->grid.size) - 1.0;
  const auto hides = [&](const glm::dvec3& voxel) {
    const auto& [low, high] = *test.editor->views->scene.clip.box;
    return glm::any(glm::lessThan(voxel, low)) || glm::any(glm::greaterThan(voxel, high));
  };
  const glm::dvec3 within(last.x / 2, box_of(test).high.y == last.y + 0.5 ? last.y : 0, last.z / 2);
  CHECK_FALSE(hides(within));
  CHECK_FALSE(hides(within + glm::dvec3(0, 0, 200)));
  CHECK_FALSE(hides(within - glm::dvec3(300, 0, 200)));
  CHECK(hides({within.x, last.y - within.y, within.z}));  // a point of the front half
  test.play("drag \"Clip face z+\" 0 40");
  CHECK(hides(within + glm::dvec3(0, 0, 200)));
  CHECK_FALSE(hides(within - glm::dvec3(0, 0, 200)));
}

TEST_CASE("replay: Escape drops the drag of a clip handle") {
  SmallEditor test({1280, 720});
  test.play("key Num1\n wait 0.3\n key Alt+B");
  const ClipBox before = box_of(test);
  test.play("press \"Clip face z+\"\n move 500 500");
  CHECK(test.editor->views->preview_visibility);
  test.play("expect \"text:Snap\"\n key Escape\n release");
  CHECK(box_of(test) == before);
  CHECK_FALSE(test.editor->views->preview_visibility);
}

TEST_CASE("replay: clip box and plane are moved by number, one edit each") {
  SmallEditor test({1280, 1100});
  test.play(R"(
    key Alt+B
    double-click "Clipping/Z to"
    type "15"
    key Return
    expect edit "Move clip box"
  )");
  const Grid& grid = test.editor->document().volume->grid;
  CHECK((world_from_voxel(grid) * glm::dvec3(0, 0, box_of(test).high.z)).z == doctest::Approx(15));
  const auto steps = test.editor->history->steps().size();
  test.play("move \"3D view/view\"\n key Shift+Alt+B");
  const ClipPlane plane = test.editor->document().visibility->clip_plane;
  test.play("double-click Clipping/Plane\n type \"12.5\"\n key Return\n expect edit \"Move clip plane\"");
  CHECK(test.editor->history->steps().size() == steps + 2);
  const ClipPlane& moved = test.editor->document().visibility->clip_plane;
  const glm::dvec3 middle = world_from_voxel(grid) * ((glm::dvec3(grid.size) - 1.0) * 0.5);
  CHECK(glm::dot(moved.point - middle, plane.normal) == doctest::Approx(12.5));
  CHECK(moved.normal == plane.normal);
}

TEST_CASE("replay: a turntable never replaces pictures unasked") {
  const TemporaryFolder folder;
  SmallEditor test({1024, 640});
  std::ofstream(folder / "turn-0001.png") << "mine";
  export_turntable(*test.editor, folder / "turn.png", 3);
  test.play("expect dialog yes\n click dialog/Cancel\n wait-job");
  CHECK_FALSE(std::filesystem::exists(folder / "turn-0000.png"));
  CHECK(std::filesystem::file_size(folder / "turn-0001.png") == 4);
  export_turntable(*test.editor, folder / "turn.png", 3);
  test.play("click dialog/Replace");
  for (int i = 0; i < 200 && test.editor->jobs->busy(); ++i) test.player.step();
  test.play("wait-job");
  for (const char* name : {"turn-0000.png", "turn-0001.png", "turn-0002.png"})
    CHECK(std::filesystem::file_size(folder / name) > 500);
  CHECK_FALSE(std::filesystem::exists(folder / "turn-0003.png"));
}
