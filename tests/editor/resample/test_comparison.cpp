// SPDX-License-Identifier: AGPL-3.0-or-later
// Compares results with the volume at rest, and selects, renames and deletes them.
#include "editor/context/comparison.h"
#include "editor/context/operator.h"
#include "editor/context/pick_list.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/resample/difference_overlay.h"
#include "editor/resample/results.h"
#include "editor/shown/compare_wipe.h"
#include "editor/shown/fem_live_view.h"
#include "editor/ui/ui.h"
#include "tests/editor/small_limb.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

namespace {

// Makes a result from a ball of another size, on its own grid.
std::shared_ptr<const Result> result(const Document& document, const std::string& name, double radius, double shift) {
  auto volume = std::make_shared<LabelVolume>(*document.volume);
  volume->grid.origin.z += shift;
  const AffineTransform world = world_from_voxel(volume->grid);
  for (int z = 0; z < volume->grid.size.z; ++z)
    for (int y = 0; y < volume->grid.size.y; ++y)
      for (int x = 0; x < volume->grid.size.x; ++x)
        volume->at({x, y, z}) = glm::length(world * glm::dvec3(x, y, z)) < radius ? 17 : 0;
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
    editor->history->commit("Results", next);
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

  // Slices step through the grid of the posed volume, which lies 6 mm higher than that at rest.
  test.play("key Ctrl+Alt+Q\n move Axial/view\n expect text:posed");
  for (int i = 0; i < 40; ++i) test.host->events.push(Wheeled{1});
  test.player.settle();
  const Grid& grid = test.volume(1)->grid;
  CHECK(test.editor->views->cross_hair.z ==
        doctest::Approx((world_from_voxel(grid) * glm::dvec3(0, 0, grid.size.z - 1)).z));
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
  test.play("expect \"text:Release to show the other result again\"\n key-up F");
  CHECK(test.shown().get() == test.volume(1));

  test.play("key 4\n expect \"text:A  One\"\n expect \"text:B  Two\"\n wait-idle");
  REQUIRE(test.editor->views->other_scene);
  CHECK(test.editor->views->other_scene->volume.get() == test.volume(0));
  CHECK(test.shown().get() == test.volume(1));
  // Left of the wipe line the view shows A, right of it B. 25 mm from the middle only A has tissue.
  const Rect view = *test.editor->screen->layout.place_of(ViewId::Body);
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
  // The list of tissues under the pointer is that of the pointer's side: four tissues of the body at rest, one of the
  // result "Two".
  test.editor->comparison->a = "";
  test.play("wait-idle");
  const auto listed = [&](double millimetres) {
    hovered(millimetres);
    test.host->events.push(KeyChanged{Key::Alt, true});
    for (const bool down : {true, false}) test.host->events.push(ButtonChanged{MouseButton::Left, down});
    test.player.settle();
    test.host->events.push(KeyChanged{Key::Alt, false});
    test.player.settle();
    const std::vector<Pickable> below = test.editor->pick_list->rows;
    test.play("key Escape");
    return std::count(below.begin(), below.end(), Pickable{std::nullopt, 111});
  };
  CHECK(listed(-4) == 1);
  CHECK(listed(4) == 0);
  test.editor->comparison->a = "One";
  test.play("wait-idle");
  test.play("drag \"3D view/wipe\" 200 0\n wait-idle");
  CHECK(test.editor->comparison->share > 0.6f);
  CHECK(hovered(25));
  test.play("double-click \"3D view/wipe\"");
  CHECK(test.editor->comparison->share == 0.5f);
  run(*test.editor, "compare.swap");
  test.player.settle();
  CHECK(test.shown().get() == test.volume(0));
  test.play("key 4");
  CHECK_FALSE(test.editor->views->other_scene);
}

TEST_CASE("results: A and B stand side by side, one camera sees both, and what the pointer is on belongs to its side") {
  Compared test;
  test.play(
      "click Two/row\n click One/row Shift\n move \"3D view/view\"\n key 3\n wait-idle\n expect \"text:One\"\n expect "
      "\"text:Two\"");
  CHECK(side_by_side(*test.editor));
  const Layout& layout = test.editor->screen->layout;
  REQUIRE(layout.view_places.size() == 2);
  const Rect b = *layout.place_of(ViewId::Body), a = layout.view_places[1].rect;
  CHECK(layout.view_places[1].side_a);
  CHECK(a.high.x < b.low.x);
  CHECK(a.size() == b.size());
  // The smaller ball is shown on the right. 25 mm from the middle, only A has tissue.
  const auto label_at = [&](const Rect& view, double millimetres) -> int {
    const render::Camera& camera = test.editor->views->body.camera;
    glm::dvec2 pixel;
    REQUIRE(render::project(camera, camera.world_from_view * glm::dvec3(millimetres, 0, 0), glm::ivec2(view.size()),
                            pixel));
    test.host->events.push(PointerMoved{view.low + glm::vec2(pixel)});
    test.player.settle();
    return test.editor->views->hover.inside ? test.editor->views->hover.label : 0;
  };
  CHECK(label_at(a, 25) == 17);
  CHECK(label_at(b, 25) == 0);
  CHECK(label_at(b, 5) == 17);

  const glm::dquat before = test.editor->views->body.camera.world_from_view;
  test.play("drag \"3D view A/view\" 60 10 MMB\n wait-idle");
  CHECK(test.editor->views->body.camera.world_from_view != before);
  CHECK(label_at(a, 25) == 17);
  CHECK(label_at(b, 25) == 0);

  test.play("drag \"3D view/divider\" 120 0\n wait-idle");
  CHECK(test.editor->comparison->share > 0.55f);
  CHECK(layout.view_places[1].rect.width() > a.width() + 100);
  test.play("drag \"3D view/divider\" 900 0\n wait-idle");
  CHECK(layout.view_places[0].rect.width() > 0.19f * layout.views.width());
  test.play("double-click \"3D view/divider\"");
  CHECK(test.editor->comparison->share == 0.5f);

  // Slices are shown twice too, and a clip box cuts both sides.
  test.play("key Ctrl+Alt+Q\n wait-idle");
  CHECK(layout.view_places.size() == 8);
  test.play("move \"Axial A/view\"");
  CHECK(test.editor->views->hover.view == ViewId::Axial);
  CHECK(scene_at_pointer(*test.editor, *layout.view_at(test.editor->ui->input.pointer)).volume.get() == test.volume(0));
  run(*test.editor, "view.one");
  test.play("wait-idle\n move \"3D view/view\"\n key Alt+B\n wait-idle");
  CHECK(test.editor->views->scene.clip.box);
  CHECK(test.editor->views->other_scene->clip.box);
  // Other workspaces have one view. The Resample workspace, when it is shown again, has two.
  test.play("key Ctrl+3\n wait-idle");
  CHECK(layout.view_places.size() == 1);
  test.play("key Ctrl+4\n wait-idle\n move \"3D view/view\"");
  CHECK(layout.view_places.size() == 2);
  test.play("key 3\n wait-idle");
  CHECK(layout.view_places.size() == 1);
  CHECK_FALSE(test.editor->views->other_scene);
  CHECK(test.shown().get() == test.volume(1));
}

TEST_CASE("results: where A and B differ is marked on both sides and counted by tissue") {
  Compared test;
  test.play("click Two/row\n move \"3D view/view\"\n key 3\n key D\n wait-idle\n expect \"text:Voxels that differ\"");
  const ComparedVolumes* found = compared_volumes(*test.editor);
  REQUIRE(found);
  CHECK(found->a.volume == test.editor->document().volume);
  CHECK(found->b.volume.get() == test.volume(1));
  const LabelVolume &rest = *found->a.volume, &two = *found->b.volume;
  // The result "Two" lies exactly two voxels higher than the body at rest.
  DifferingSide::Count skin, muscle;
  for (int z = 0; z < rest.grid.size.z; ++z)
    for (int y = 0; y < rest.grid.size.y; ++y)
      for (int x = 0; x < rest.grid.size.x; ++x) {
        const Label here = rest.at({x, y, z}), there = two.at_or_air({x, y, z - 2});
        if (here == 143) ++(there == 0 ? skin.air : skin.other_tissue);
        if (here == 17 && there == 0) ++muscle.air;
      }
  CHECK(found->a.differing.counts.at(143) == skin);
  CHECK(found->a.differing.counts.at(17) == muscle);
  CHECK(found->a.differing.counts.at(111).air == 0);
  CHECK(found->b.differing.counts.at(17).air == 0);
  const auto& views = *test.editor->views;
  REQUIRE(views.scene.weights);
  REQUIRE(views.other_scene->weights);
  CHECK(views.scene.weights->field == found->b.field);
  CHECK(views.other_scene->weights->field == found->a.field);

  // Beside the pointer, the label at the same position on the other side is shown.
  test.play("move \"3D view A/view\"\n wait-idle\n expect \"text:in B: \"\n expect \"text:Skin, A and B\"");
  test.play("key 2\n wait-idle");  // B alone still shows the differences
  CHECK(views.scene.weights->field == found->b.field);
  test.play("key 1\n wait-idle");
  CHECK(views.scene.weights->field == found->a.field);
  run(*test.editor, "fem.show_tissues");
  test.player.settle();
  CHECK_FALSE(views.scene.weights);
  CHECK_FALSE(shows_difference(*test.editor));
}

TEST_CASE("results: gates, changes and provenance are read from the report of the result that is shown") {
  Compared test;
  Document next = test.editor->document();
  auto judged = std::make_shared<Result>(*next.results[0]);
  judged->report =
      R"({"version": "9.8", "settings": {"fit_joints": true, "quality": "fine", "method": "fem"},
        "inputs": [{"path": "/tmp/x/rig.json", "sha256": "0123456789abcdef0123456789abcdef"}],
    "seconds": {"solve": 3.25, "total": 4}, "peak_memory_mb": 123.4, "mesh": {"inverted": 3},
      "bones": [{"name": "Fore", "rigid_residual_mm": 0.25}], "total": {"overlap_voxels": 7},
    "tissues": [{"name": "Skin", "label": 143, "voxels_before": 6000, "mm3_before": 1000, "mm3_after": 900,
      "volume_change_percent": -10}]})";
  judged->from_pose = std::make_shared<const Pose>(rest_pose(*next.armature));
  next.results[0] = judged;
  test.editor->history->commit("Report", next);
  test.editor->ui->open_sections["Provenance"] = true;
  for (const char* folded : {"Outliner", "Tissues", "Running", "Resample"})
    test.editor->ui->open_sections[folded] = false;
  test.play("click One/row\n wait-idle");
  for (const char* text : {"-10.00 %", "0.250 mm", "7 voxels", "not checked", "within", "9.8", "fine", "rig.json",
                           "0123456789abcdef", "3.25 s", "123 MB"}) {
    INFO(std::string(text));
    CHECK(test.fact(std::string("text:") + text) == "shown");
  }
  test.play("click \"Bone parts rigid\"");
  CHECK(test.editor->selection->bone == 1);
  test.play("click \"Each tissue within 1 %\"");
  CHECK(test.editor->selection->tissue == 143);
  test.play("click \"Quality gates/fold\"\n wait-idle\n click rig.json");
  CHECK(test.host->clipboard() == "0123456789abcdef0123456789abcdef");
  const std::string text = text_of_report("One", *facts_of(*test.editor, test.editor->document().results[0]));
  for (const char* part : {"FAILED   Each tissue within 1 %", "-10.00 %  Skin", "passed   Joint limits", "Quality",
                           "0123456789abcdef0123456789abcdef"}) {
    INFO(text);
    CHECK(text.find(part) != std::string::npos);
  }
}

TEST_CASE("results: the Resample workspace opens with the result of the current pose, if there is one") {
  Compared test;
  Document next = test.editor->document();
  Pose bent = rest_pose(*next.armature);
  bent.rotation[1] = glm::angleAxis(0.5, glm::dvec3(1, 0, 0));
  const auto posed_by = [&](std::size_t at, const Pose& pose) {
    auto one = std::make_shared<Result>(*next.results[at]);
    one->from_pose = std::make_shared<const Pose>(pose);
    next.results[at] = one;
  };
  posed_by(0, rest_pose(*next.armature));
  posed_by(1, bent);
  next.pose = std::make_shared<const Pose>(bent);
  test.editor->history->commit("Pose", next);
  test.play("click One/row\n wait-idle");
  CHECK(test.shown().get() == test.volume(0));
  test.play("key Ctrl+3\n wait-idle\n key Ctrl+4\n wait-idle");
  CHECK(test.shown().get() == test.volume(1));
  // The body at rest stays shown if the user selected it. A stale result is not shown.
  test.play("click Two/row\n wait-idle");
  CHECK(test.shown() == test.editor->document().volume);
  test.play("key Ctrl+3\n wait-idle\n key Ctrl+4\n wait-idle");
  CHECK(test.shown() == test.editor->document().volume);
  test.play("click One/row\n wait-idle");
  const Document fresh = test.editor->document();
  Document stale = fresh;
  auto grown = std::make_shared<Armature>(*stale.armature);
  grown->bones[1].tail.z += 1;
  stale.armature = grown;
  test.editor->history->commit("Rig", stale);
  test.play("key Ctrl+3\n wait-idle\n key Ctrl+4\n wait-idle");
  CHECK(test.shown().get() == test.volume(0));
  test.editor->history->commit("Rig", fresh);
  test.play("key Ctrl+3\n wait-idle\n key Ctrl+4\n wait-idle");
  CHECK(test.shown().get() == test.volume(1));
  // If the pose has no result, the user's selection stays.
  next = test.editor->document();
  bent.rotation[0] = glm::angleAxis(0.2, glm::dvec3(1, 0, 0));
  next.pose = std::make_shared<const Pose>(bent);
  test.editor->history->commit("Pose", next);
  test.play("key Ctrl+3\n wait-idle\n key Ctrl+4\n wait-idle");
  CHECK(test.shown().get() == test.volume(1));
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
  CHECK(test.shown().get() == test.volume(0));  // the same result is still shown
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
TEST_CASE(
    "results: bones are fitted and weights painted on the body itself, and to show a result goes where it is seen") {
  Compared test;
  test.play("key Ctrl+4\n click One/row\n wait-idle");
  REQUIRE(shown_result(*test.editor));
  const std::string chosen = shown_result(*test.editor)->name;
  for (const char* workspace : {"Ctrl+1", "Ctrl+2"}) {
    test.play(std::string("key ") + workspace + "\n wait-idle");
    CHECK_FALSE(shown_result(*test.editor));
    CHECK(shown_volume(*test.editor) == test.editor->document().volume);
    CHECK(chosen_result(*test.editor)->name == chosen);
  }
  test.play("key Ctrl+1\n wait-idle");
  run(*test.editor, "result.show_last");
  CHECK(test.fact("workspace") == "resample");
  CHECK(shown_result(*test.editor) == test.editor->document().results.back());
}
