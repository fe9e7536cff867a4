// SPDX-License-Identifier: AGPL-3.0-or-later
// Results beside the volume at rest: chosen, renamed, deleted, compared.
#include "editor/results.h"
#include "tests/editor/small_limb.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

// A ball of another size stands for a posed one, in a grid of its own.
std::shared_ptr<const Result> result(const Document& document, const std::string& name, double radius, double shift) {
  auto volume = std::make_shared<LabelVolume>(*document.volume);
  volume->grid.origin.z += shift;
  const AffineTransform world = world_from_voxel(volume->grid);
  for (int z = 0; z < volume->grid.size.z; ++z)
    for (int y = 0; y < volume->grid.size.y; ++y)
      for (int x = 0; x < volume->grid.size.x; ++x) volume->at({x, y, z}) = glm::length(world * glm::dvec3(x, y, z)) < radius ? 17 : 0;
  Result one;
  one.name = name;
  one.method = "dqs";
  one.volume = volume;
  one.from_volume = document.volume;
  one.from_tissues = document.tissues;
  one.from_armature = document.armature;
  one.from_weights = document.weights;
  return std::make_shared<const Result>(one);
}

struct Compared : LimbEditor {
  Compared() {
    Document next = editor->document();
    next.results = {result(next, "One", 30, 0), result(next, "Two", 20, 6)};
    editor->history.commit("Results", next);
    play("key Ctrl+4");
  }
  const std::shared_ptr<const LabelVolume>& shown() const { return editor->views->scene.volume; }
  const LabelVolume* volume(std::size_t result) const { return editor->document().results[result]->volume.get(); }
};

}  // namespace

TEST_CASE("results: a click shows one, a second click the volume at rest, in the body and in slices") {
  Compared test;
  const LabelVolume* rest = test.editor->document().volume.get();
  CHECK(test.shown().get() == rest);
  test.play("click One/row");
  CHECK(test.shown().get() == test.volume(0));
  test.play("click Two/row");
  CHECK(test.shown().get() == test.volume(1));

  // Slices of the posed volume step through its own grid, 6 mm higher than the one at rest.
  test.play("key Ctrl+Alt+Q\n move Axial/view\n expect text:posed");
  for (int i = 0; i < 40; ++i) test.host->events.push(Wheeled{1});
  test.player.settle();
  const Grid& grid = test.volume(1)->grid;
  CHECK(test.editor->views->cross_hair.z == doctest::Approx((world_from_voxel(grid) * glm::dvec3(0, 0, grid.size.z - 1)).z));
  test.play("click Two/row");
  CHECK(test.shown().get() == rest);
  test.play("click One/row\n click \"At rest/row\"");
  CHECK(test.shown().get() == rest);
  run(*test.editor, "result.show_last");
  test.player.settle();
  CHECK(test.shown().get() == test.volume(1));
  run(*test.editor, "result.toggle");
  test.player.settle();
  CHECK(test.shown().get() == rest);
}

TEST_CASE("results: A and B are shown in turn, held against one another, and wiped") {
  Compared test;
  test.play("click Two/row\n click One/row Shift\n move \"3D view/view\"\n key 1");
  CHECK(test.shown().get() == test.volume(0));
  test.play("key 2");
  CHECK(test.shown().get() == test.volume(1));
  test.play("key-down F");
  CHECK(test.shown().get() == test.volume(0));
  test.play("expect \"text:Let go\"\n key-up F");
  CHECK(test.shown().get() == test.volume(1));

  test.play("key 4\n expect \"text:A  One\"\n expect \"text:B  Two\"\n wait-idle");
  REQUIRE(test.editor->views->other_scene);
  CHECK(test.editor->views->other_scene->volume.get() == test.volume(0));
  CHECK(test.shown().get() == test.volume(1));
  // What lies left of the line is read from A, what lies right of it from B: 25 mm from the middle only A has tissue.
  const Rect view = *test.editor->layout.place_of(ViewId::Body);
  const glm::dvec3 right = test.editor->views->body.camera.world_from_view * glm::dvec3(1, 0, 0);
  const auto hovered = [&](double millimetres) {
    glm::dvec2 pixel;
    REQUIRE(render::project(test.editor->views->body.camera, right * millimetres, glm::ivec2(view.size()), pixel));
    test.host->events.push(PointerMoved{view.low + glm::vec2(pixel)});
    test.player.settle();
    return test.editor->views->hover.inside;
  };
  CHECK(hovered(-25));
  CHECK_FALSE(hovered(25));
  // So is what lies behind it: at rest there are four tissues, in Two there is one.
  test.editor->comparison.a = "";
  test.play("wait-idle");
  const auto listed = [&](double millimetres) {
    hovered(millimetres);
    test.host->events.push(KeyChanged{Key::Alt, true});
    for (const bool down : {true, false}) test.host->events.push(ButtonChanged{MouseButton::Left, down});
    test.player.settle();
    test.host->events.push(KeyChanged{Key::Alt, false});
    test.player.settle();
    const std::vector<Pickable> below = test.editor->pick_list;
    test.play("key Escape");
    return std::count(below.begin(), below.end(), Pickable{std::nullopt, 111});
  };
  CHECK(listed(-4) == 1);
  CHECK(listed(4) == 0);
  test.editor->comparison.a = "One";
  test.play("wait-idle");
  test.play("drag \"3D view/wipe\" 200 0\n wait-idle");
  CHECK(test.editor->comparison.share > 0.6f);
  CHECK(hovered(25));
  test.play("double-click \"3D view/wipe\"");
  CHECK(test.editor->comparison.share == 0.5f);
  run(*test.editor, "compare.swap");
  test.player.settle();
  CHECK(test.shown().get() == test.volume(0));
  test.play("key 4");
  CHECK_FALSE(test.editor->views->other_scene);
}

TEST_CASE("results: without a choice the comparison is of the volume at rest and the last result") {
  Compared test;
  test.play("move \"3D view/view\"\n key 4");
  REQUIRE(test.editor->views->other_scene);
  CHECK(test.editor->views->other_scene->volume == test.editor->document().volume);
  CHECK(test.shown().get() == test.volume(1));
  test.play("key 1");
  CHECK(test.shown() == test.editor->document().volume);
}

TEST_CASE("results: one is renamed in its row and deleted, and both are undone") {
  Compared test;
  test.play(R"(
    click One/row
    click result.rename
    type "Elbow"
    key Return
    expect edit "Rename One"
  )");
  CHECK(test.editor->document().results[0]->name == "Elbow");
  CHECK(test.shown().get() == test.volume(0));  // still shown
  test.play("double-click Two/row\n type \"Elbow\"\n key Return\n expect edit \"Rename Two\"");
  CHECK(test.editor->document().results[1]->name == "Elbow (2)");
  test.play("double-click \"Elbow (2)/row\"\n type \"Other\"\n key Escape");
  CHECK(test.editor->document().results[1]->name == "Elbow (2)");
  test.play("move \"3D view/view\"\n key Delete\n expect edit \"Delete Elbow (2)\"");
  CHECK(test.editor->document().results.size() == 1);
  CHECK(test.shown() == test.editor->document().volume);
  test.play("key Ctrl+Z\n key Ctrl+Z\n key Ctrl+Z");
  CHECK(test.editor->document().results.size() == 2);
  CHECK(test.editor->document().results[0]->name == "One");
  CHECK(test.editor->document().results[1]->name == "Two");
}
