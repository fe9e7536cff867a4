// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/screen.h"
#include "editor/shown/test_pose.h"

#include "editor/pose/live_preview.h"
#include "editor/pose/pose_edits.h"
#include "tests/editor/operator_proofs.h"
#include "tests/editor/paint_editor.h"

namespace limber::test {

using namespace editor;

namespace {

void weigh(Stage& s) {
  Document next = s.document();
  next.weights = half_weights(*next.volume);
  Pose pose = rest_pose(*next.armature);
  flex(pose, *next.armature, 1, 40);
  next.pose = std::make_shared<const Pose>(pose);
  s.editor().history->commit("Weigh", next);
  s.editor().selection->bone = 1;
  s.editor().selection->bones = {1};
  s.play("key Ctrl+2\n move \"3D view/view\"\n key Num1\n wait-idle");
}

std::function<bool(Stage&, const Seen&)> bent(double degrees) {
  return [=](Stage& s, const Seen& b) {
    return bend(s.editor()) == degrees && static_cast<int>(s.editor().history->position()) == b.position;
  };
}

glm::dvec3 posed(const PaintEditor& test, const glm::dvec3& rest) {
  return posed_from_rest(*test.editor->document().armature, shown_pose(*test.editor))[1] * rest;
}

}  // namespace

std::vector<Proof> proofs_of_test_poses() {
  return {
      {"skin.posed", "key Tab\n wait-idle",
       [](Stage& s, const Seen&) { return s.editor().trial->posed && s.editor().views->scene.pose; }, Shows::InBody, "",
       weigh},
      {"skin.bend_more", "click \"Edit weights/Test pose/Bend further\"\n wait-idle", bent(5), Shows::InBody},
      {"skin.unbend", "click \"Edit weights/Test pose/Unbend\"\n wait-idle", bent(0), Shows::InBody},
      {"skin.bend_less", "click \"Edit weights/Test pose/Bend less\"\n wait-idle", bent(-5)},
      {"skin.bend_by_wheel",
       "move \"3D view/view\"\n key-down Shift\n key-down Ctrl\n wheel \"3D view/view\" 3\n key-up Ctrl\n key-up "
       "Shift\n wait-idle",
       bent(10)},
  };
}

TEST_CASE("operators: the body is posed on trial while its weights are painted") {
  Stage stage;
  stage.open_limb();
  prove(stage, proofs_of_test_poses());
}

TEST_CASE("test pose: a joint is bent on trial, the project's pose stays, and another bone may be chosen meanwhile") {
  PaintEditor test;
  const int steps = test.steps();
  const auto pose = test.editor->document().pose;
  CHECK_FALSE(shows_pose(*test.editor));
  set_bend(*test.editor, 60);
  test.play("wait-idle");
  CHECK(shows_pose(*test.editor));
  REQUIRE(test.editor->views->scene.pose);
  CHECK(test.editor->views->scene.posed_from_rest.size() == 2);
  CHECK(test.editor->document().pose == pose);
  CHECK(test.steps() == steps);
  test.choose(0);
  CHECK(bend(*test.editor) == 0);
  CHECK(why_not_bend(*test.editor) == "A bone without a parent cannot be bent: select another bone");
  CHECK(test.editor->trial->degrees == 60);
  CHECK(shows_pose(*test.editor));
  // The sidebar shows the bend and a button to undo it.
  for (const char* folded : {"Steps", "Bones", "Layers"}) test.editor->ui->open_sections[folded] = false;
  test.play("key N\nwait-idle\nclick \"sidebar/sections/Brush/skin.unbend\"\nwait-idle");
  CHECK_FALSE(shows_pose(*test.editor));
  CHECK(!test.editor->views->scene.pose);
  // The test pose does not change the project's pose: the Pose workspace shows the body at rest.
  set_bend(*test.editor, 0);
  test.choose(1);
  set_bend(*test.editor, 60);
  test.play("key Ctrl+3\nwait-idle");
  CHECK(shown_pose(*test.editor) == rest_pose(*test.editor->document().armature));
}

TEST_CASE(
    "test pose: a stroke on the bent body lands where the pointer is seen, in 3D and in slices, and the body follows "
    "it") {
  for (const bool slice : {false, true}) {
    PaintEditor test;
    set_bend(*test.editor, -50);
    test.play("wait-idle");
    REQUIRE(test.editor->views->scene.pose);
    const auto map = test.editor->views->scene.pose;
    test.choose(0);
    // Takes a point on the surface of the lower half; for slices, a point inside it.
    const double angle = glm::radians(slice ? -80.0 : -60.0), radius = slice ? 25 : 40;
    const glm::dvec3 rest(0, -radius * std::cos(angle), radius * std::sin(angle));
    const glm::dvec3 seen = posed(test, rest);
    CHECK(glm::distance(seen, rest) > 15);
    std::string pixel;
    if (slice) {
      std::optional<ViewPlace> place;
      for (const ViewPlace& view : test.editor->screen->layout.view_places)
        if (view.id != ViewId::Body) place = view;
      REQUIRE(place);
      SliceState& shown = slice_of(*test.editor->views, place->id);
      shown.camera.centre = test.editor->views->cross_hair = seen;
      test.editor->ui->touch();
      test.play("wait-idle");
      const glm::vec2 at = place->rect.low + pixel_of(shown.camera, seen, place->rect.size());
      pixel =
          std::to_string(at.x / test.editor->ui->look.scale) + " " + std::to_string(at.y / test.editor->ui->look.scale);
    } else {
      pixel = test.pixel_of(seen);
    }
    INFO(slice, " at ", pixel);
    test.play("move " + pixel + "\nwait-idle");
    REQUIRE(test.editor->skin->painting->place);
    const BrushPlace place = *test.editor->skin->painting->place;
    CHECK(glm::distance(place.seen, seen) < 4);
    CHECK(glm::distance(place.rest, rest) < 6);
    test.press();
    test.release();
    test.play("wait-idle");
    CHECK(test.last_edit() == "Add Upper");
    const auto [count, furthest] = test.painted(0, rest, false);
    CHECK(count > 20);
    CHECK(furthest < 12 + 6 + 6);
    CHECK(test.editor->views->scene.pose);
    CHECK(test.editor->views->scene.pose != map);
    // The painted tissue now moves with the upper half, so the pointer is over other tissue or none.
    test.play("move " + pixel + "\nwait-idle");
    const auto after = test.editor->skin->painting->place;
    CHECK((!after || glm::distance(after->rest, rest) > 6));
  }
}

TEST_CASE("test pose: bones are posed for the project in the Skin workspace too, and shown so") {
  PaintEditor test;
  test.play("move \"3D view/view\"\nkey R\nkey X\nkey 4\nkey 5\nkey Return\nwait-idle");
  REQUIRE(test.editor->document().pose);
  CHECK(*test.editor->document().pose != rest_pose(*test.editor->document().armature));
  CHECK(test.editor->trial->posed);
  CHECK(test.editor->views->scene.pose);
  test.play("key Tab\nwait-idle");
  CHECK(!test.editor->views->scene.pose);
}

TEST_CASE("test pose: Tab shows rest and brings back what was bent on trial, posed or both") {
  PaintEditor test;
  set_bend(*test.editor, 60);
  test.play("wait-idle\nkey Tab\nwait-idle");
  CHECK_FALSE(shows_pose(*test.editor));
  test.play("key Tab\nwait-idle");
  CHECK(bend(*test.editor) == 60);
  CHECK_FALSE(test.editor->trial->posed);
  CHECK(shows_pose(*test.editor));
  // After the bend is cleared, only the pose remains to be shown.
  clear_bend(*test.editor);
  test.editor->trial->posed = false;
  test.play("move \"3D view/view\"\nkey Tab");
  CHECK(test.editor->trial->posed);
  CHECK(test.editor->trial->degrees == 0);
}

}  // namespace limber::test
