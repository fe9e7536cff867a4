// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "core/rig/joint_limits.h"
#include "editor/context/interaction.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/pose_editing.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/transform_settings.h"
#include "editor/motion/timeline.h"
#include "editor/pose/pose_edits.h"
#include "editor/pose/pose_tools.h"
#include "editor/ui/ui.h"
#include "tests/editor/small_clip.h"
#include "tests/editor/small_limb.h"

using namespace limber;
using namespace limber::editor;
using limber::test::LimbEditor;

namespace {

struct PosingEditor : LimbEditor {
  explicit PosingEditor(const glm::ivec2& size = {1280, 720}, const Preferences& preferences = {})
      : LimbEditor(size, preferences) {
    play("key Ctrl+3\nkey Num1\nwait-idle");
    choose(1);
  }

  void choose(int bone) {
    *editor->selection = {};
    editor->selection->bone = bone;
    editor->selection->bones = {bone};
  }
  std::string last_edit() const { return editor->history->steps()[editor->history->position()].label; }
  Pose pose() const { return pose_of(editor->document()); }
  // Returns a bone's rotation about an axis, degrees; NaN if it also turns about another axis.
  double degrees(int bone, const glm::dvec3& axis) const {
    const SwingTwist parts = swing_twist(pose().rotation[bone], axis);
    return glm::length(parts.swing) < 1e-6 ? parts.twist * 180 / std::numbers::pi : NAN;
  }
  glm::dvec2 seen(const glm::dvec3& world) const {
    glm::dvec2 pixel;
    const Rect* place = editor->screen->layout.place_of(ViewId::Body);
    REQUIRE(render::project(editor->views->body.camera, world, glm::ivec2(place->size()), pixel));
    return pixel + glm::dvec2(place->low);
  }
  // Moves the pointer to a pixel of the window. Scripts use pixels at scale 1.
  void pointer_to(const glm::dvec2& pixel) {
    const glm::dvec2 at = pixel / double(editor->ui->look.scale);
    play("move " + std::to_string(at.x) + " " + std::to_string(at.y));
  }
};

}  // namespace

TEST_CASE(
    "posing: R turns the chosen bone as far as the pointer goes round its head, in both projections and at twice the "
    "size") {
  for (const float scale : {1.0f, 2.0f})
    for (const bool parallel : {false, true}) {
      Preferences preferences;
      preferences.scale = scale;
      PosingEditor test({1600, 1000}, preferences);
      test.editor->posing->keep_limits = false;
      if (parallel) test.play("key Num5\nwait-idle");
      const glm::dvec2 head = test.seen({0, 0, 0});
      const auto at = [&](double degrees) {
        const double a = degrees * std::numbers::pi / 180;
        return head + 150.0 * glm::dvec2(std::cos(a), -std::sin(a));
      };
      test.pointer_to(at(10));
      test.play("key R");
      for (double degrees = 15; degrees <= 50; degrees += 5) test.pointer_to(at(degrees));
      CHECK(test.editor->interaction->modal);
      test.play("key Return");
      CHECK(!test.editor->interaction->modal);
      INFO("scale ", scale, ", parallel ", parallel);
      // From the front, the eye is at -y, so a counter-clockwise turn is about -y.
      CHECK(test.degrees(1, {0, -1, 0}) == doctest::Approx(40).epsilon(0.0005));
    }
}

TEST_CASE("posing: the bones follow while they are turned, and go back with Escape") {
  PosingEditor test;
  const auto shown = [&] { return test.editor->views->scene.posed_from_rest.at(1).rotation; };
  test.play("key R\nkey X\nkey 4\nkey 5\nwait-idle");
  CHECK(glm::angle(shown()) == doctest::Approx(std::numbers::pi / 4));
  CHECK(test.pose() == rest_pose(*test.editor->document().armature));
  test.play("key Escape\nwait-idle");
  CHECK(shown() == glm::dquat(1, 0, 0, 0));
}

TEST_CASE("posing: an axis lock, a typed number, Escape and undo") {
  PosingEditor test;
  test.play("key R\nkey X\nkey 4\nkey 5\nkey Return");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(45));
  CHECK(test.last_edit() == "Rotate Fore");

  test.play("key R\nkey X\nkey 2\nkey 0\nkey Escape");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(45));
  test.play("key Ctrl+Z");
  CHECK(test.pose() == rest_pose(*test.editor->document().armature));
  test.play("key Ctrl+Shift+Z");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(45));

  // The second X selects the bone's own x axis instead of the world's. Backspace corrects a digit.
  test.play("key Alt+R\nkey R\nkey X\nkey X\nkey 3\nkey 9\nkey Backspace\nkey 5\nkey Return");
  const glm::dvec3 own = rest_axes(test.editor->document().armature->bones[1])[0];
  CHECK(std::abs(test.degrees(1, own)) == doctest::Approx(35));
}

TEST_CASE("posing: joints stop at their limits, unless they are told not to") {
  PosingEditor test;
  test.play("key R\nkey X\nkey 1\nkey 7\nkey 0\nkey Return");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(2.5 * 180 / std::numbers::pi));
  test.play("key Ctrl+Z\nkey R\nkey X\nkey -\nkey 3\nkey 0\nkey Return");
  CHECK(test.pose() == rest_pose(*test.editor->document().armature));
  test.play("click \"Edit/Pose/Keep to joint limits\"\nkey R\nkey X\nkey 1\nkey 7\nkey 0\nkey Return");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(170));
}

TEST_CASE("posing: with Ctrl the angle snaps, and R again turns like a trackball") {
  PosingEditor test;
  test.editor->posing->keep_limits = false;
  const glm::dvec2 head = test.seen({0, 0, 0});
  test.pointer_to(head + glm::dvec2(100, 0));
  test.play("key R\nkey-down Ctrl");
  test.pointer_to(head + glm::dvec2(100, -42));
  test.play("key Return\nkey-up Ctrl");
  CHECK(test.degrees(1, {0, -1, 0}) == doctest::Approx(25));

  test.play("key Alt+R\nkey R\nkey R");
  test.pointer_to(head + glm::dvec2(150, -42));
  test.play("key Return");
  CHECK(test.pose() != rest_pose(*test.editor->document().armature));
  CHECK(std::isnan(test.degrees(1, {0, -1, 0})));
}

TEST_CASE("posing: G lets the end of the bone follow the pointer, and the limb with it") {
  PosingEditor test;
  test.editor->posing->keep_limits = false;
  const glm::dvec2 from = test.seen({0, 0, -36}), to = test.seen({20, 0, 10});
  test.pointer_to(from);
  test.play("key G");
  for (int i = 1; i <= 8; ++i) test.pointer_to(from + (to - from) * (i / 8.0));
  test.play("key Return");
  const auto posed = posed_from_rest(*test.editor->document().armature, test.pose());
  CHECK(glm::distance(posed[1] * glm::dvec3(0, 0, -36), glm::dvec3(20, 0, 10)) < 0.5);
  CHECK(test.last_edit() == "Reach with Fore");

  test.play("key Alt+G");
  test.choose(0);
  test.play("key G\nkey Z\nkey 1\nkey 2\nkey Return");
  CHECK(glm::distance(test.pose().root_translation, glm::dvec3(0, 0, 12)) < 1e-9);
  test.play("key Alt+G");
  CHECK(test.pose().root_translation == glm::dvec3(0));
}

TEST_CASE("posing: a pose is copied, pasted and cleared bone by bone") {
  PosingEditor test;
  test.play("key R\nkey X\nkey 4\nkey 0\nkey Return\nkey Ctrl+C\nkey Alt+R");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(0));
  test.play("key Ctrl+V");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(40));
  // Mirroring keeps a turn about x, since these bones belong to no side.
  test.play("key Ctrl+M");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(40));
}

TEST_CASE("posing: bones are chosen along the rig") {
  PosingEditor test;
  test.play("key [");
  CHECK(test.editor->selection->bone == 0);
  test.play("key ]");
  CHECK(test.editor->selection->bone == 1);
  test.play("key Shift+[");
  CHECK(test.editor->selection->bones == std::set<int>{0, 1});
  test.choose(0);
  test.play("key L");
  CHECK(test.editor->selection->bones == std::set<int>{0, 1});
  test.play("key Alt+A\nkey A");
  CHECK(test.editor->selection->bones.size() == 2);
}

TEST_CASE("posing: a blend goes right to the next key and left to the one before, and Escape brings the pose back") {
  for (const double scale : {1.0, 2.0}) {
    Preferences preferences;
    preferences.scale = scale;
    LimbEditor test(scale > 1 ? glm::ivec2(1800, 1200) : glm::ivec2(900, 600), preferences);
    test.editor->history->reset(limber::test::bending_limb(), "Open limb");
    test.play("key Ctrl+3\n wait-idle");
    for (const int frame : {10, 30}) {
      go_to_frame(*test.editor, frame);
      run(*test.editor, "motion.insert_key");
    }
    go_to_frame(*test.editor, 20);
    test.play("wait-idle\n move 300 300\n key Shift+Alt+E\n move 400 300\n wait-idle");
    const auto bend = [&] { return limber::test::bend_of(shown_pose(*test.editor)); };
    CHECK(bend() == doctest::Approx(25));  // 100 of 200 pixels: half way from 20 to 30
    test.play("move 150 300\n wait-idle");
    CHECK(bend() == doctest::Approx(12.5));
    test.play("key Escape\n wait-idle");
    CHECK(bend() == doctest::Approx(20));
    test.play("move 300 300\n key Shift+Alt+E\n key -\n key 1\n key 0\n key 0\n key Return\n wait-idle");
    CHECK(bend() == doctest::Approx(10));
    test.play("key Ctrl+Z\n wait-idle");
    CHECK(bend() == doctest::Approx(20));
  }
}

TEST_CASE(
    "posing: between two keys a breakdown goes from the one to the other, and without them from rest to the pose") {
  PosingEditor test;
  test.editor->posing->keep_limits = false;
  const auto bend = [&](const std::string& angle) {
    return "move \"3D view/view\"\nkey R\nkey X\n" + angle + "key Return\n";
  };
  test.play(bend("key 2\nkey 0\n") + "key I\nwait-idle");
  go_to_frame(*test.editor, 10);
  test.play(bend("key 6\nkey 0\n") + "key I\nwait-idle");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(80));
  go_to_frame(*test.editor, 3);
  test.play("move \"3D view/view\"\nkey Shift+E\nwait-idle");
  CHECK(glm::degrees(swing_twist(shown_pose(*test.editor).rotation[1], {1, 0, 0}).twist) == doctest::Approx(50));
  test.play("key 2\nkey 5\nkey Return");
  CHECK(test.last_edit() == "Breakdown");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(35));
  // After the last key there is no next pose to move towards.
  go_to_frame(*test.editor, 20);
  test.play("move \"3D view/view\"\nkey Shift+E\nkey 2\nkey 5\nkey Return");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(20));
}

TEST_CASE(
    "posing: the sidebar's numbers turn a hinge within its limits and any other bone about its own axes, and move the "
    "root") {
  PosingEditor test({1280, 900});
  const auto type = [&](const std::string& field, const std::string& number) {
    test.play("double-click \"" + field + "\"\nkey Ctrl+A\ntype \"" + number + "\"\nkey Return\nwait-idle");
  };
  test.play("wait-idle");
  type("Bone/Angle", "40");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(40));
  CHECK(test.last_edit() == "Rotate Fore");
  type("Bone/Angle", "170");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(2.5 * 180 / std::numbers::pi));
  test.play("key Ctrl+Z\nkey Ctrl+Z\nwait-idle");
  CHECK(test.pose() == rest_pose(*test.editor->document().armature));

  test.choose(0);
  test.play("wait-idle");
  type("Bone/Rotation, \u00b0 Y", "30");
  const Bone& upper = test.editor->document().armature->bones[0];
  CHECK(test.degrees(0, rest_axes(upper)[1]) == doctest::Approx(30));
  type("Bone/Shift, mm Z", "-7");
  CHECK(test.pose().root_translation.z == doctest::Approx(-7));
  CHECK(test.last_edit() == "Move body");

  // Angles that are set are read back, for bones with any axes.
  for (int i = 0; i < 50; ++i) {
    const glm::dvec3 angles(std::fmod(37.0 * i, 340) - 170, std::fmod(23.0 * i, 170) - 85,
                            std::fmod(71.0 * i, 340) - 170);
    const Bone bone{"b", -1, {0, 0, 0}, {1, 2.0 * i - 40, 3}, 0.1 * i};
    CHECK(glm::distance(own_angles(bone, turned_by_own_angles(bone, angles)), angles) < 1e-6);
  }
}

TEST_CASE("posing: the right button on a bone lists what can be done with it") {
  PosingEditor test;
  const auto press_at = [&](const glm::dvec3& point) {
    test.pointer_to(test.seen(point));
    test.play("wait-idle");
    for (const bool down : {true, false}) test.host->events.push(ButtonChanged{MouseButton::Right, down});
    test.player.settle();
  };
  test.play("click view.xray_display\nwait-idle");
  press_at({0, 0, 18});
  CHECK(test.editor->menus->shown_popup == "Posed bone");
  CHECK(test.editor->selection->bone == 0);
  CHECK(test.fact("text:Upper") == "shown");
  test.play("key Escape\nwait-idle\nkey Ctrl+1\nwait-idle");
  press_at({0, 0, -18});
  CHECK(test.editor->menus->shown_popup == "Bone");
  CHECK(test.editor->selection->bone == 1);
}

TEST_CASE("posing: with X-mirror pins and poles come, move and go on both sides") {
  PosingEditor test;
  Document next = test.editor->document();
  Armature rig;
  rig.bones.push_back({"Trunk", -1, {0, 0, 0}, {0, 0, 10}, 0, {}});
  for (const double side : {1.0, -1.0}) {
    const std::string s = side > 0 ? ".L" : ".R";
    const int above = static_cast<int>(rig.bones.size());
    rig.bones.push_back({"Arm" + s, 0, {side * 5, 0, 8}, {side * 20, 4, 8}, 0, {}});
    rig.bones.push_back({"Fore" + s, above, {side * 20, 4, 8}, {side * 35, 0, 8}, 0, {}});
  }
  next.armature = std::make_shared<const Armature>(rig);
  test.editor->history->commit("Two arms", next);
  test.editor->transform_settings->x_mirror = true;
  test.choose(2);
  test.play("move \"3D view/view\"\n key Shift+P");
  CHECK(anchors_of(test.editor->document()).pins == std::set<std::string>{"Fore.L", "Fore.R"});
  test.play("click \"Edit/IK/IK pole\"");
  const auto poles = [&] { return anchors_of(test.editor->document()).poles; };
  REQUIRE(poles().size() == 2);
  CHECK(glm::distance(poles().at("Fore.R"), poles().at("Fore.L") * glm::dvec3(-1, 1, 1)) < 1e-9);

  // Dragging a pole moves the pole of the other side and both limbs with it.
  begin_tool(*test.editor, begin_dragging_pole(*test.editor));
  test.play("key Z\n key 4\n key 0\n key Return");
  CHECK(glm::distance(poles().at("Fore.R"), poles().at("Fore.L") * glm::dvec3(-1, 1, 1)) < 1e-9);
  const auto posed = posed_from_rest(rig, test.pose());
  const glm::dvec3 left = posed[2] * rig.bones[2].head, right = posed[4] * rig.bones[4].head;
  CHECK(left.z > 8.5);
  CHECK(glm::distance(right, left * glm::dvec3(-1, 1, 1)) < 1e-6);
  for (const int fore : {2, 4}) CHECK(glm::distance(posed[fore] * rig.bones[fore].tail, rig.bones[fore].tail) < 0.05);

  test.play("key Ctrl+Alt+I");
  CHECK(anchors_of(test.editor->document()) == Anchors{});
  test.play("key Shift+I");
  CHECK(anchors_of(test.editor->document()).pins.size() == 2);
  CHECK(poles().size() == 2);
  test.editor->transform_settings->x_mirror = false;
  test.play("key Shift+P");
  CHECK(anchors_of(test.editor->document()).pins == std::set<std::string>{"Fore.R"});
}

TEST_CASE(
    "posing: angles of a joint that rests bent count from straight, a typed turn that its limit holds says so, and "
    "limits are told apart") {
  PosingEditor test({1280, 900});
  Document bent = test.editor->document();
  auto rig = std::make_shared<Armature>(*bent.armature);
  rig->bones[1].tail = glm::angleAxis(1.0, glm::dvec3(1, 0, 0)) * glm::dvec3(0, 0, -36);
  rig->bones[1].limits.minimum = -1;
  rig->bones[1].limits.maximum = glm::radians(150.0) - 1;
  bent.armature = rig;
  test.editor->history->reset(bent, "Open bent limb");
  test.choose(1);
  test.play("wait-idle\n expect \"text:57.3\"\n expect \"text:0 to 150\u00b0\"");
  test.play("double-click Bone/Angle\n key Ctrl+A\n type \"0\"\n key Return\n wait-idle");
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(glm::degrees(-1.0)));
  // A straight joint bends no further back, and the status line gives the reason.
  test.play(
      "move \"3D view/view\"\n key R\n key X\n key -\n key 6\n key 0\n wait-idle\n expect \"text:At the joint limit of "
      "Fore (0\u00b0 to 150\u00b0)\"\n expect \"text:Flexion 0.0\u00b0 of 150\u00b0\"");
  const std::size_t toasts = test.editor->messages->log.size();
  test.play("key Return\n wait-idle");
  CHECK(test.editor->messages->log.size() == toasts + 1);
  CHECK(test.degrees(1, {1, 0, 0}) == doctest::Approx(glm::degrees(-1.0)));
  test.play("key R\n key X\n key 5\n key 4\n wait-idle\n expect \"text:Flexion 54.0\u00b0 of 150\u00b0\"\n key Escape");
  test.editor->posing->keep_limits = false;
  test.play(
      "move \"3D view/view\"\n key R\n key X\n key -\n key 2\n key 0\n key Return\n wait-idle\n expect \"text:beyond "
      "0\u00b0 by 20.0\u00b0\"");
}

TEST_CASE("posing: the sidebar shows a bone's quaternion, whose parts are typed, and pins and poles as boxes") {
  PosingEditor test({1280, 900});
  test.choose(0);
  test.play("wait-idle\n double-click \"Bone/Quaternion X\"\n key Ctrl+A\n type \"0.6\"\n key Return\n wait-idle");
  const glm::dquat turned = test.pose().rotation[0];
  CHECK(turned.x == doctest::Approx(0.6));
  CHECK(turned.w == doctest::Approx(0.8));
  test.choose(1);
  test.play("wait-idle\n click \"Bone/Pin joint\"\n wait-idle");
  CHECK(anchors_of(test.editor->document()).pins.contains("Fore"));
  test.play("click Bone/Pole\n wait-idle");
  CHECK(anchors_of(test.editor->document()).poles.contains("Fore"));
  test.play("click \"Bone/Pin joint\"\n wait-idle");
  CHECK_FALSE(anchors_of(test.editor->document()).pins.contains("Fore"));
}
