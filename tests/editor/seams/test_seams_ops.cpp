// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/project_io.h"
#include "editor/context/screen.h"
#include "editor/resample/results.h"
#include "tests/editor/glued_editor.h"
#include "tests/editor/operator_proofs.h"

namespace limber::test {

namespace {

// Gives the small limb the bone names of an arm. No two parts of its body touch at rest.
void make_arm(Stage& s) {
  Document next = s.document();
  Armature rig = *next.armature;
  rig.bones[0].name = "LeftUpperArm";
  rig.bones[1].name = "LeftForearm";
  next.armature = std::make_shared<const Armature>(rig);
  next.weights = nullptr;
  s.editor().history->commit("Make arm", next);
  s.play("key Ctrl+2\n move \"3D view/view\"\n key Num1\n wait-idle");
}

void cut_once(Stage& s) {
  Document next = s.document();
  Seams seams(next.volume->grid.size);
  seams.cut({12, 10, 20}, 0);
  next.seams = std::make_shared<const Seams>(seams);
  s.editor().history->commit("Cut", next);
  s.play("wait-idle");
}

double share_of_lime(const std::vector<std::uint8_t>& rgba) {
  std::int64_t lime = 0;
  for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) lime += rgba[i] > 150 && rgba[i + 1] > 200 && rgba[i + 2] < 130;
  return double(lime) / double(rgba.size() / 4);
}

}  // namespace

std::vector<Proof> proofs_of_seams() {
  return {
      {"skin.find_seams", "click \"Edit/Weights/Find seams\"\n wait-job\n wait-idle",
       [](Stage& s, const Seen&) { return shown_seams(s.editor()).has_value(); }, Shows::Nothing, "", make_arm},
      {"skin.seam_brush", "click \"strip/skin.seam_brush\"",
       [](Stage& s, const Seen&) { return s.editor().seams->brush; }},
      {"skin.show_seams", "click \"Edit/Weights/Show seams\"",
       [](Stage& s, const Seen&) { return !s.editor().seams->shown; }},
      {"skin.clear_seams", "click \"Edit/Weights/Remove seams\"\n wait-idle",
       [](Stage& s, const Seen&) { return s.document().seams && s.document().seams->empty(); }, Shows::Nothing, "",
       cut_once},
  };
}

TEST_CASE("operators: seams are found, shown, painted and removed") {
  Stage stage;
  stage.open_limb();
  prove(stage, proofs_of_seams());
}

TEST_CASE("seams: the button finds them, the list says between what, a click on a row puts the cross-hair there") {
  GluedEditor test;
  test.play("key N\nwait-idle");
  test.open_only("Seams");
  CHECK(test.fact("text:Seams not searched yet") == "shown");
  test.play("click \"sidebar/sections/Seams/Find seams\"\nwait-job\nwait-idle");
  const std::int64_t faces = test.faces();
  CHECK(faces > 200);
  CHECK_FALSE(test.editor->document().seams);  // seams that were found are not stored as an edit
  test.play("wait-job\nwait-idle");
  const auto* pairs = counted_pairs(*test.editor);
  REQUIRE(pairs);
  REQUIRE(pairs->size() >= 2);
  const std::string name = "Left " + pairs->front().first.substr(5) + " to trunk";
  CHECK(test.fact("text:" + name) == "shown");
  test.play("click \"sidebar/sections/Seams/" + name + "/name\"\nwait-idle");
  CHECK(glm::distance(test.editor->views->cross_hair, pairs->front().middle) < 1e-9);
}

TEST_CASE("seams: a stroke of the brush cuts along its way and is one step to undo, with Ctrl it erases") {
  GluedEditor test;
  test.play("click \"Edit/Weights/Find seams\"\nwait-job\nwait-idle\nclick \"strip/skin.seam_brush\"\nwait-idle");
  test.editor->skin->painting->radius = 20;
  const std::int64_t found = test.faces();
  // Draws a stroke down the middle of the trunk's front.
  test.stroke(test.at({-30, -40, 300}), test.at({-30, -40, 100}));
  CHECK(test.steps() == 1);
  CHECK(test.last_edit() == "Cut seam");
  const std::int64_t cut = test.faces();
  CHECK(cut > found + 50);
  REQUIRE(test.editor->document().seams);
  // All of the cut lies in one sheet, no deeper than the brush radius below the surface.
  int beside = 0;
  const AffineTransform world = world_from_voxel(test.editor->document().volume->grid);
  test.editor->document().seams->for_each([&](const glm::ivec3& lower, int) {
    const glm::dvec3 p = world * glm::dvec3(lower);
    if (p.x < 20) beside += std::abs(p.x + 30) > 12 || p.y > -44 + 20 + 16;
  });
  CHECK(beside == 0);
  test.play("key Ctrl+Z\nwait-idle");
  CHECK(test.faces() == found);
  CHECK_FALSE(test.editor->document().seams);
  test.play("key Ctrl+Shift+Z\nwait-idle");
  CHECK(test.faces() == cut);

  test.stroke(test.at({-30, -40, 300}), test.at({-30, -40, 200}), true);
  CHECK(test.last_edit() == "Erase seam");
  CHECK(test.faces() < cut);
  CHECK(test.faces() > found);
  // Escape cancels the stroke that is being drawn.
  const int steps = test.steps();
  test.play("move " + test.at({-30, -40, 150}));
  test.host->events.push(ButtonChanged{MouseButton::Left, true});
  test.player.settle();
  test.play("move " + test.at({-10, -40, 60}) + "\nkey Escape\nwait-idle");
  test.host->events.push(ButtonChanged{MouseButton::Left, false});
  test.player.settle();
  CHECK(test.steps() == steps);
  // Choosing a weight brush ends the seam brush.
  test.play("click \"strip/skin.brush_add\"\nwait-idle");
  CHECK_FALSE(test.editor->seams->brush);
}

TEST_CASE("seams: a stroke in a slice cuts to both sides of it, and what was cut by hand stays in the project") {
  GluedEditor test(2);
  test.play(
      "key Ctrl+Alt+Q\nwait-idle\nclick \"Edit/Weights/Find seams\"\nwait-job\nwait-idle\nclick "
      "\"strip/skin.seam_brush\"\nwait-idle");
  test.editor->skin->painting->radius = 12;
  test.editor->views->cross_hair = {-30, 0, 200};
  test.play("wait-idle");
  const ViewPlace* axial = nullptr;
  for (const ViewPlace& place : test.editor->screen->layout.view_places)
    if (place.id == ViewId::Axial) axial = &place;
  REQUIRE(axial);
  const ViewProjection seen(*test.editor, *axial);
  const auto pixel = [&](const glm::dvec3& point) {
    const glm::dvec2 at = *seen.pixel_of(point) / 2.0;
    return std::to_string(at.x) + " " + std::to_string(at.y);
  };
  const std::int64_t found = test.faces();
  test.stroke(pixel({-36, -20, 200}), pixel({-36, 20, 200}));
  CHECK(test.faces() > found + 20);
  const AffineTransform world = world_from_voxel(test.editor->document().volume->grid);
  int beside = 0;
  test.editor->document().seams->for_each([&](const glm::ivec3& lower, int) {
    const glm::dvec3 p = world * glm::dvec3(lower);
    if (p.x < 20) beside += std::abs(p.x + 36) > 10 || std::abs(p.z - 200) > 16;
  });
  CHECK(beside == 0);

  const Path path = test.folder.path() / "kept.limber";
  DocumentWriter writer;
  create_project({.document = test.editor->document()}, path, writer);
  CHECK(*read_project(path).document.seams == *test.editor->document().seams);
}

TEST_CASE("seams: they are drawn in 3D and in slices, at rest alone, and can be hidden") {
  for (const float scale : {1.0f, 2.0f}) {
    GluedEditor test(scale);
    test.play("key Ctrl+Alt+Q\nwait-idle\nclick \"Edit/Weights/Find seams\"\nwait-job\nwait-idle");
    test.editor->views->cross_hair = {57, 0, 200};
    test.play("wait-idle");
    const auto picture = [&] {
      test.play("shot-now " + (test.folder / "seams.png").string());
      return render::read_png(test.folder / "seams.png").rgba;
    };
    const double with = share_of_lime(picture());
    CHECK(with > 0.0003);
    test.play("click \"Edit/Weights/Show seams\"\nwait-idle");
    CHECK(share_of_lime(picture()) < with / 10);
  }
}

TEST_CASE("seams: those by hand go to weights, and to the worker that resamples") {
  GluedEditor test;
  Document next = test.editor->document();
  // Without seams, the arm stays connected to the trunk.
  next.seams = std::make_shared<const Seams>(next.volume->grid.size);
  test.editor->history->commit("Remove seams", next);
  test.play("click \"Edit/Weights/Heat diffusion\"\nwait-job\nwait-idle");
  REQUIRE(test.editor->document().weights);
  const SkinWeights grown = *test.editor->document().weights;
  test.play("click \"Edit/Weights/Find seams\"\nwait-job\nwait-idle");
  CHECK(test.last_edit() == "Find seams");
  CHECK_FALSE(test.editor->document().seams);
  CHECK(why_weights_are_old(*test.editor) == "Weights are older than the seams");
  CHECK(parted_tissue(*test.editor)->seams());
  test.play("click \"Edit/Weights/Heat diffusion\"\nwait-job\nwait-idle");
  CHECK(why_weights_are_old(*test.editor) == "");
  CHECK_FALSE(*test.editor->document().weights == grown);

  Document cut = test.editor->document();
  cut.seams = *body_seams().known(seam_source(cut));
  Pose pose = rest_pose(*cut.armature);
  pose.rotation[1] = glm::angleAxis(glm::radians(-30.0), glm::dvec3(0, 1, 0));
  cut.pose = std::make_shared<const Pose>(pose);
  test.editor->history->commit("Keep seams", cut);
  test.play("key Ctrl+4\nwait-idle\nkey Ctrl+Return\nwait-job\nwait-idle");
  REQUIRE(test.editor->document().results.size() == 1);
  const auto result = test.editor->document().results[0];
  CHECK(result->from_seams == cut.seams);
  CHECK(stale_reason(test.editor->document(), *result) == "");
  Document other = test.editor->document();
  other.seams = std::make_shared<const Seams>(other.volume->grid.size);
  CHECK(stale_reason(other, *result) == "seams changed");
}

}  // namespace limber::test
