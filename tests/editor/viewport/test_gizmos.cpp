// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <numbers>

#include "core/rig/joint_limits.h"
#include "editor/context/interaction.h"
#include "editor/context/modal_tool.h"
#include "editor/context/operator.h"
#include "editor/context/pick_list.h"
#include "editor/context/pose_editing.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/transform_settings.h"
#include "editor/context/view_projection.h"
#include "editor/pose/pose_edits.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/ui/ui.h"
#include "editor/viewport/gizmo_draw.h"
#include "tests/editor/small_limb.h"

using namespace limber;
using namespace limber::editor;
using limber::test::LimbEditor;

namespace {

constexpr double kPi = std::numbers::pi;

// An editor with the two bones and a body of very few voxels, so that pictures are drawn quickly.
struct GizmoEditor : LimbEditor {
  explicit GizmoEditor(float scale = 1, bool parallel = false)
      : LimbEditor(scale > 1 ? glm::ivec2(1240, 840) : glm::ivec2(800, 560), preferences_of(scale)) {
    Document bare = editor->document();
    auto volume = std::make_shared<LabelVolume>(*bare.volume);
    volume->voxels.assign(volume->voxels.size(), 0);
    volume->at({12, 10, 15}) = 111;
    bare.volume = volume;
    editor->history->reset(bare, "Open bare limb");
    editor->preferences->reduce_motion = true;
    play("key N\nkey Ctrl+3\nkey Num1\nwait-idle");
    if (parallel) play("key Num5\nwait-idle");
    // The view is oblique, so that no ring is seen edge-on.
    editor->views->body.camera = render::orbited(editor->views->body.camera, {60, 35});
    editor->selection->bone = 1;
    editor->selection->bones = {1};
    editor->posing->keep_limits = false;
    play("wait-idle");
  }
  static Preferences preferences_of(float scale) {
    Preferences preferences;
    preferences.scale = scale;
    return preferences;
  }

  ViewProjection view() const { return body_seen(*editor).value(); }
  Gizmo gizmo() const {
    const auto gizmo = gizmo_in(*editor, view());
    REQUIRE(gizmo);
    return *gizmo;
  }
  // Returns the pixel of the point at `angle` on the ring about `axis`. The ring's radius is 86 pixels.
  glm::dvec2 on_ring(int axis, double angle) const { return view().pixel_of(ring(axis).at(angle)).value(); }
  Ring ring(int axis) const { return ring_of(view(), editor->ui->look.scale, gizmo().centre, gizmo().axes[axis], 86); }
  // Returns the angle on the ring about `axis` at which the ring is nearest to the eye.
  double front(int axis) const {
    const auto [begin, by] = ring(axis).front(view());
    return begin + by / 2;
  }
  void pointer_to(const glm::dvec2& pixel) {
    const glm::dvec2 at = pixel / double(editor->ui->look.scale);
    char line[80];
    std::snprintf(line, sizeof line, "move %.6f %.6f", at.x, at.y);
    play(line);
  }
  void press() { button(true); }
  void release() { button(false); }
  void button(bool down) {
    host->events.push(ButtonChanged{MouseButton::Left, down});
    player.settle();
  }
  Pose pose() const { return pose_of(editor->document()); }
  double degrees(int bone, const glm::dvec3& axis) const {
    const SwingTwist parts = swing_twist(pose().rotation[bone], axis);
    return glm::length(parts.swing) < 1e-6 ? glm::degrees(parts.twist) : NAN;
  }
  std::string last_edit() const { return editor->history->steps()[editor->history->position()].label; }
};

}  // namespace

TEST_CASE("gizmo: a read-out stands wholly inside its view, and off the point that it speaks of") {
  Look look;
  for (const float scale : {1.0f, 2.0f}) {
    look.scale = scale;
    for (const glm::vec2 size : {glm::vec2(240, 160), glm::vec2(477, 214), glm::vec2(956, 430)}) {
      const Rect view{{44 * scale, 70 * scale}, glm::vec2(44, 70) * scale + size * scale};
      for (float x = 0; x <= 1; x += 0.0625f)
        for (float y = 0; y <= 1; y += 0.0625f) {
          const glm::vec2 point = view.low + view.size() * glm::vec2(x, y);
          const Rect place = place_of_read_out(look, view, point);
          CHECK(view.contains(place));
          CHECK_FALSE(place.contains(point));
        }
    }
  }
}

TEST_CASE(
    "gizmos: dragging a ring turns the bone by the angle swept round it, in both projections and at twice the size") {
  for (const float scale : {1.0f, 2.0f})
    for (const bool parallel : {false, true}) {
      GizmoEditor test(scale, parallel);
      test.play("click \"strip/tool.rotate\"\nwait-idle");
      for (int axis = 0; axis < 3; ++axis) {
        INFO("scale ", scale, ", parallel ", parallel, ", axis ", axis);
        std::vector<glm::dvec2> path;
        const double begin = test.front(axis);
        for (int i = 0; i <= 3; ++i) path.push_back(test.on_ring(axis, begin + i * 32.0 * kPi / 180));
        test.pointer_to(path[0]);
        test.press();
        CHECK(test.editor->interaction->modal);
        for (const glm::dvec2& pixel : path) test.pointer_to(pixel);
        const auto position = test.editor->history->position();
        test.release();
        CHECK(!test.editor->interaction->modal);
        glm::dvec3 world(0);
        world[axis] = 1;
        CHECK(std::abs(test.degrees(1, world) - 96) < 0.1);
        CHECK(test.editor->history->position() == position + 1);
        test.play("key Ctrl+Z");
        CHECK(test.pose() == rest_pose(*test.editor->document().armature));
      }
    }
}

TEST_CASE("gizmos: a hinge that lies askew has a ring of its own, and turns by the angle swept round it") {
  for (const bool local : {false, true}) {
    GizmoEditor test;
    Document next = test.editor->document();
    Armature armature = *next.armature;
    armature.bones[1].limits.axis = glm::normalize(glm::dvec3(1, -0.9, 0));
    next.armature = std::make_shared<const Armature>(armature);
    test.editor->history->commit("Hinge", next);
    test.editor->posing->keep_limits = true;
    test.editor->transform_settings->space = local ? Space::Local : Space::Global;
    test.play("click \"strip/tool.rotate\"\nwait-idle");
    int along = -1;
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(glm::dot(test.gizmo().axes[axis], armature.bones[1].limits.axis)) > 0.999999) along = axis;
    REQUIRE(along >= 0);
    const double sense = glm::dot(test.gizmo().axes[along], armature.bones[1].limits.axis) < 0 ? -1 : 1,
                 begin = test.front(along);
    test.pointer_to(test.on_ring(along, begin));
    test.press();
    for (int i = 1; i <= 4; ++i) test.pointer_to(test.on_ring(along, begin + sense * glm::radians(47.8) * i / 4));
    CHECK(test.editor->interaction->modal->title().find("about the hinge") != std::string::npos);
    test.release();
    CHECK(std::abs(test.degrees(1, armature.bones[1].limits.axis) - 47.8) < 0.1);
  }
}

TEST_CASE("gizmos: the ring about the line of sight turns like the pointer goes round the joint") {
  for (const bool parallel : {false, true}) {
    GizmoEditor test(1, parallel);
    test.editor->interaction->tool = Tool::Rotate;
    const glm::dvec2 centre = test.view().pixel_of(test.gizmo().centre).value();
    const auto at = [&](double degrees) {
      return centre + 108.0 * glm::dvec2(std::cos(glm::radians(degrees)), -std::sin(glm::radians(degrees)));
    };
    const glm::dvec3 to_eye = test.view().towards_eye;
    test.pointer_to(at(100));
    test.press();
    for (int degrees = 100; degrees <= 300; degrees += 50) test.pointer_to(at(degrees));
    test.release();
    // A drag by 200 degrees is the same rotation as 160 degrees the other way.
    CHECK(std::abs(std::abs(test.degrees(1, to_eye)) - 160) < 0.1);
  }
}

TEST_CASE(
    "gizmos: what the pointer takes hold of is the ring nearest to the eye, then the view's ring, then the ball") {
  GizmoEditor test;
  test.editor->interaction->tool = Tool::Rotate;
  const auto at = [&](const glm::dvec2& pixel) { return part_at(test.gizmo(), test.view(), 1, pixel); };
  const glm::dvec2 centre = test.view().pixel_of(test.gizmo().centre).value();
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(at(test.on_ring(axis, test.front(axis))) == GizmoPart{GizmoPart::Kind::Ring, axis});
    // The half of a ring that is behind the ball cannot be picked.
    const auto behind = at(test.on_ring(axis, test.front(axis) + kPi));
    CHECK(!(behind == GizmoPart{GizmoPart::Kind::Ring, axis}));
  }
  CHECK(at(centre + glm::dvec2(108, 0) * 1.0) == GizmoPart{GizmoPart::Kind::ViewRing});
  CHECK(at(centre) == GizmoPart{GizmoPart::Kind::Trackball});
  CHECK(!at(centre + glm::dvec2(130, 0)));
  // Where two rings cross, the ring nearer to the eye is picked. Two rings cross on the axis of the third ring. The
  // test takes the crossing on the axis that points most towards the eye.
  const glm::dmat3 axes = test.gizmo().axes;
  const glm::dvec3 to_eye = test.view().direction_to_eye(test.gizmo().centre);
  int nearest = 0;
  for (int axis = 1; axis < 3; ++axis)
    if (std::abs(glm::dot(axes[axis], to_eye)) > std::abs(glm::dot(axes[nearest], to_eye))) nearest = axis;
  const double sign = glm::dot(axes[nearest], to_eye) > 0 ? 1 : -1;
  const auto crossing =
      at(test.view().pixel_of(test.gizmo().centre + sign * test.ring(0).radius * axes[nearest]).value());
  REQUIRE(crossing);
  CHECK(crossing->kind == GizmoPart::Kind::Ring);
  CHECK(crossing->axis != nearest);
}

TEST_CASE("gizmos: a ring seen edge on is not taken hold of") {
  GizmoEditor test(1, true);
  test.play("key Num1\nwait-idle");
  test.editor->interaction->tool = Tool::Rotate;
  // From the front, the rings about x and z are seen as lines across the ball.
  const glm::dvec2 centre = test.view().pixel_of(test.gizmo().centre).value();
  CHECK(part_at(test.gizmo(), test.view(), 1, centre + glm::dvec2(0, 40)) == GizmoPart{GizmoPart::Kind::Trackball});
  CHECK(part_at(test.gizmo(), test.view(), 1, centre + glm::dvec2(40, 0)) == GizmoPart{GizmoPart::Kind::Trackball});
  CHECK(part_at(test.gizmo(), test.view(), 1, centre + glm::dvec2(86, 0)) == GizmoPart{GizmoPart::Kind::Ring, 1});
}

TEST_CASE("gizmos: during a drag Ctrl snaps, Shift goes slowly, digits are typed and Escape drops") {
  GizmoEditor test;
  test.editor->interaction->tool = Tool::Rotate;
  const double begin = test.front(0);
  const auto to = [&](double degrees) { return test.on_ring(0, begin + glm::radians(degrees)); };
  const glm::dvec2 from = to(0), far = to(33);

  test.pointer_to(from);
  test.press();
  test.play("key-down Ctrl");
  test.pointer_to(far);
  test.release();
  test.play("key-up Ctrl");
  CHECK(std::abs(test.degrees(1, {1, 0, 0}) - 35) < 1e-6);
  test.play("key Ctrl+Z");

  test.pointer_to(from);
  test.press();
  test.play("key-down Shift");
  test.pointer_to(far);
  test.release();
  test.play("key-up Shift");
  CHECK(test.degrees(1, {1, 0, 0}) > 1);
  CHECK(test.degrees(1, {1, 0, 0}) < 5);
  test.play("key Ctrl+Z");

  test.pointer_to(from);
  test.press();
  test.pointer_to(far);
  test.play("key 1\nkey 2\nkey .\nkey 5");
  test.release();
  CHECK(std::abs(test.degrees(1, {1, 0, 0}) - 12.5) < 1e-6);
  test.play("key Ctrl+Z");

  const std::size_t steps = test.editor->history->steps().size();
  test.pointer_to(from);
  test.press();
  test.pointer_to(far);
  test.play("key Escape");
  CHECK(!test.editor->interaction->modal);
  test.release();
  CHECK(test.pose() == rest_pose(*test.editor->document().armature));
  CHECK(test.editor->history->steps().size() == steps);
  CHECK(test.editor->views->preview_pose == nullptr);
}

TEST_CASE("gizmos: a click in the ball picks what lies below it, and changes nothing") {
  GizmoEditor test;
  test.editor->interaction->tool = Tool::Rotate;
  const glm::dvec2 upper = test.view().pixel_of({0, 0, 12}).value();
  REQUIRE(part_at(test.gizmo(), test.view(), 1, upper));
  const std::size_t steps = test.editor->history->steps().size();
  test.pointer_to(upper);
  test.press();
  test.release();
  CHECK(test.editor->selection->bone == 0);
  CHECK(test.editor->history->steps().size() == steps);
}

TEST_CASE("gizmos: rings and locks go by the chosen space") {
  GizmoEditor test;
  test.editor->interaction->tool = Tool::Rotate;
  test.play("move \"3D view/view\"\nkey R\nkey Z\nkey 3\nkey 0\nkey Return");
  const auto posed = posed_from_rest(*test.editor->document().armature, test.pose());
  test.editor->transform_settings->space = Space::Local;
  CHECK(glm::distance(test.gizmo().axes[1], posed[1].rotation * glm::dvec3(0, 0, -1)) < 1e-9);
  test.editor->transform_settings->space = Space::Parent;
  CHECK(glm::distance(test.gizmo().axes[1], glm::dvec3(0, 0, -1)) < 1e-9);
  test.editor->transform_settings->space = Space::View;
  CHECK(glm::distance(test.gizmo().axes[2], test.view().towards_eye) < 1e-9);

  // The first press of the axis key uses the selected space, and the second uses the world's axes if they differ.
  test.play("key Ctrl+Z\nkey R\nkey Z\nkey 2\nkey 0\nkey Return");
  CHECK(std::abs(test.degrees(1, test.view().towards_eye) - 20) < 1e-6);
  test.play("key Ctrl+Z\nkey R\nkey Z\nkey Z\nkey 2\nkey 0\nkey Return");
  CHECK(std::abs(test.degrees(1, {0, 0, 1}) - 20) < 1e-6);
}

TEST_CASE("gizmos: an arrow moves the body along its axis, a square in its plane") {
  for (const bool parallel : {false, true}) {
    GizmoEditor test(1, parallel);
    test.editor->interaction->tool = Tool::Move;
    test.editor->selection->bone = 0;
    test.editor->selection->bones = {0};
    const double unit = test.view().millimetres_per_pixel(test.gizmo().centre);
    const auto drag = [&](const glm::dvec3& from, const glm::dvec3& by) {
      const glm::dvec2 begin = test.view().pixel_of(from).value(), end = test.view().pixel_of(from + by).value();
      test.pointer_to(begin);
      test.press();
      REQUIRE(test.editor->interaction->modal);
      test.pointer_to((begin + end) / 2.0);
      test.pointer_to(end);
      test.release();
    };
    const glm::dvec3 head(0, 0, 36);
    drag(head + glm::dvec3(0, 0, 50 * unit), {0, 0, 17});
    CHECK(glm::distance(test.pose().root_translation * glm::dvec3(1, 1, 0), glm::dvec3(0)) < 1e-9);
    CHECK(std::abs(test.pose().root_translation.z - 17) < 0.05);
    test.play("key Ctrl+Z");
    // Dragging the square across y keeps y unchanged.
    drag(head + glm::dvec3(28 * unit, 0, 28 * unit), {9, 0, -5});
    CHECK(std::abs(test.pose().root_translation.y) < 1e-9);
    CHECK(glm::distance(test.pose().root_translation, glm::dvec3(9, 0, -5)) < 0.05);
    CHECK(test.last_edit() == "Move body");
  }
}

TEST_CASE("gizmos: any joint is dragged with the reach tool, and pinned ones stay") {
  GizmoEditor test;
  test.play("click \"strip/tool.reach\"\nwait-idle");
  *test.editor->selection = {};
  const glm::dvec2 from = test.view().pixel_of({0, 0, -36}).value(), to = test.view().pixel_of({20, 0, 10}).value();
  test.pointer_to(from);
  test.press();
  for (int i = 1; i <= 4; ++i) test.pointer_to(from + (to - from) * (i / 4.0));
  test.release();
  CHECK(test.editor->selection->bone == 1);
  CHECK(test.last_edit() == "Reach with Fore");
  const auto tip = [&] {
    return posed_from_rest(*test.editor->document().armature, test.pose())[1] * glm::dvec3(0, 0, -36);
  };
  CHECK(glm::distance(test.view().pixel_of(tip()).value(), to) < 1);

  // The body moves, and the pinned tip stays in place.
  const glm::dvec3 before = tip();
  test.play("move \"3D view/view\"\nkey Shift+P");
  CHECK(test.last_edit() == "Pin Fore");
  test.editor->selection->bone = 0;
  test.editor->selection->bones = {0};
  test.play("key G\nkey Z\nkey -\nkey 6\nkey Return");
  CHECK(std::abs(test.pose().root_translation.z + 6) < 1e-9);
  CHECK(glm::distance(tip(), before) < 0.1);
}

TEST_CASE("gizmos: a pole is dragged as one edit with the limb that turns to it, and undo takes both back") {
  GizmoEditor test;
  Document straight = test.editor->document();
  Armature armature = *straight.armature;
  armature.bones[1].limits = {};
  straight.armature = std::make_shared<const Armature>(armature);
  Pose bent = rest_pose(armature);
  bent.rotation[1] = glm::angleAxis(1.0, glm::dvec3(1, 0, 0));
  straight.pose = std::make_shared<const Pose>(bent);
  test.editor->history->commit("Bend", straight);
  test.editor->selection->bone = 1;
  test.editor->selection->bones = {1};
  test.play("move \"3D view/view\"\nclick \"Edit/IK/IK pole\"\nclick \"strip/tool.select\"\nwait-idle");
  CHECK(test.last_edit() == "Add pole to Fore");
  const auto pole = [&] { return anchors_of(test.editor->document()).poles.at("Fore"); };
  const glm::dvec3 first = pole();
  const glm::dvec2 from = test.view().pixel_of(first).value();
  test.pointer_to(from);
  test.press();
  for (int i = 1; i <= 4; ++i) test.pointer_to(from + glm::dvec2(20 * i, 0));
  test.release();
  CHECK(test.last_edit() == "Turn limb to pole");
  CHECK(glm::distance(pole(), first) > 5);
  const auto turned = test.pose();
  CHECK(turned != bent);
  test.play("key Ctrl+Z");
  CHECK(pole() == first);
  CHECK(test.pose() == bent);
  test.play("key Ctrl+Z");
  CHECK(anchors_of(test.editor->document()).poles.empty());
}

TEST_CASE("gizmos: in X-ray a bone behind the volume is picked") {
  LimbEditor test({900, 600});
  test.play("key Ctrl+3\nkey Num1\nclick view.xray_display\nwait-idle");
  // The pixel shows a point inside the ball of bone, with skin and muscle in front of it.
  const glm::dvec2 pixel = body_seen(*test.editor).value().pixel_of({0, 0, -18}).value();
  test.play("move " + std::to_string(pixel.x) + " " + std::to_string(pixel.y) + "\nwait-idle");
  CHECK(test.editor->views->hover.inside);
  for (const bool down : {true, false}) test.host->events.push(ButtonChanged{MouseButton::Left, down});
  test.player.settle();
  CHECK(test.editor->selection->bone == 1);
}

TEST_CASE("gizmos: with X-mirror the other side does the same") {
  GizmoEditor test;
  Document next = test.editor->document();
  Armature armature;
  for (const double side : {1.0, -1.0})
    armature.bones.push_back({side > 0 ? "Arm.L" : "Arm.R", -1, {side * 10, 0, 0}, {side * 30, 0, 0}});
  next.armature = std::make_shared<const Armature>(armature);
  test.editor->history->commit("Two arms", next);
  test.editor->selection->bone = 0;
  test.editor->selection->bones = {0};
  test.editor->transform_settings->x_mirror = true;
  test.play("move \"3D view/view\"\nkey R\nkey Y\nkey 3\nkey 0\nkey Return");
  const auto posed = posed_from_rest(armature, test.pose());
  const glm::dvec3 left = posed[0] * glm::dvec3(30, 0, 0), right = posed[1] * glm::dvec3(-30, 0, 0);
  CHECK(glm::distance(left, glm::dvec3(30, 0, 0)) > 5);
  CHECK(glm::distance(left * glm::dvec3(-1, 1, 1), right) < 1e-9);
}

TEST_CASE("gizmos: bones' names stand clear of the gizmo and of one another, at both scales and in both workspaces") {
  for (const float scale : {1.0f, 2.0f})
    for (const char* tool : {"key Ctrl+1\n click strip/tool.move", "key Ctrl+1\n click strip/tool.rotate",
                             "key Ctrl+3\n click strip/tool.rotate"}) {
      INFO("scale ", scale, ", ", std::string(tool));
      GizmoEditor test(scale);
      // Bones that radiate from the gizmo, more of them than there is space for names.
      Document fan = test.editor->document();
      auto rig = std::make_shared<Armature>(*fan.armature);
      for (int i = 0; i < 12; ++i) {
        const double angle = kPi * i / 6;
        rig->bones.push_back(
            {"Spoke " + std::to_string(i), 0, {0, 0, 0}, {90 * std::cos(angle), 0, 90 * std::sin(angle)}});
      }
      fan.armature = rig;
      test.editor->history->reset(fan, "Open fan");
      test.editor->views->bone_names = true;
      test.play(std::string(tool) + "\n wait-idle");
      test.editor->selection->bone = 1;
      test.editor->selection->bones = {1};
      test.play("wait-idle");
      const glm::vec2 centre(test.view().pixel_of(test.gizmo().centre).value());
      const double reach = test.gizmo().tool == Tool::Rotate ? 108 : 92;
      std::vector<Rect> names;
      for (const Widget& widget : test.editor->ui->widgets.widgets()) {
        const auto found = widget.name.find("bone name ");
        if (found == std::string::npos) continue;
        INFO(widget.name);
        CHECK(glm::distance(glm::clamp(centre, widget.rect.low, widget.rect.high), centre) >=
              reach * test.editor->ui->look.scale);
        for (const Rect& other : names) CHECK_FALSE(widget.rect.overlaps(other));
        CHECK(test.editor->screen->layout.place_of(ViewId::Body)->contains(widget.rect));
        CHECK(widget.rect.height() >= 15 * test.editor->ui->look.scale);
        names.push_back(widget.rect);
      }
      CHECK(names.size() >= 3);
      CHECK(test.editor->ui->widgets.find("bone name Fore"));
    }
}

TEST_CASE("gizmos: what lies under the pointer is listed nearest first, bones among tissues") {
  LimbEditor test;
  test.play("key Ctrl+1\n key Num1\n wait-idle");
  // The pixel shows muscle above the ball of bone that the upper bone runs through.
  const glm::dvec2 pixel = body_seen(*test.editor)->pixel_of({-2.5, 0, 20}).value();
  test.play("move " + std::to_string(pixel.x) + " " + std::to_string(pixel.y) + "\n wait-idle");
  run(*test.editor, "select.pick_list");
  test.player.settle();
  const std::vector<Pickable> expected = {{std::nullopt, 143}, {std::nullopt, 17}, {0}};
  CHECK(test.editor->pick_list->rows == expected);
  CHECK(test.editor->selection->bone == 0);
  test.play("click pick/Muscle");
  CHECK(test.editor->selection->tissue == Label{17});
  test.play("move " + std::to_string(pixel.x) + " " + std::to_string(pixel.y) + "\n wait-idle");
  run(*test.editor, "select.pick_list");
  test.player.settle();
  test.play("click \"pick/bone Upper\"");
  CHECK(test.editor->selection->bone == 0);
  CHECK_FALSE(test.editor->selection->tissue);
}

TEST_CASE(
    "gizmos: in the Pose workspace slices show the posed bones and their rings, and a ring turns the bone there") {
  LimbEditor test;
  test.play("key Ctrl+3\n click view.four\n click strip/tool.rotate\n wait-idle");
  Pose bent = rest_pose(*test.editor->document().armature);
  bent.rotation[0] = glm::angleAxis(0.5, glm::dvec3(1, 0, 0));
  commit_pose(*test.editor, "Bend", bent);
  test.editor->posing->keep_limits = false;
  test.editor->views->cross_hair = {0, 0, 0};
  for (SliceState& slice : test.editor->views->slices) slice.camera.centre = {0, 0, 0};
  test.play("wait-idle");
  const ViewPlace sagittal{ViewId::Sagittal, *test.editor->screen->layout.place_of(ViewId::Sagittal)};
  const ViewProjection view(*test.editor, sagittal);
  const auto posed = posed_from_rest(*test.editor->document().armature, bent);
  const auto point_at = [&](const glm::dvec2& pixel) {
    test.play("move " + std::to_string(pixel.x) + " " + std::to_string(pixel.y) + "\n wait-idle");
  };
  // A bone is picked where its posed line is drawn, not where its rest line is.
  point_at(view.pixel_of(posed[1] * glm::dvec3(0, 0, -20)).value());
  CHECK(bone_at_pointer(*test.editor) == 1);
  point_at(view.pixel_of(glm::dvec3(0, 0, -30)).value());
  CHECK_FALSE(bone_at_pointer(*test.editor));
  test.editor->selection->bone = 1;
  test.editor->selection->bones = {1};
  const auto gizmo = gizmo_in(*test.editor, view);
  REQUIRE(gizmo);
  CHECK(glm::distance(gizmo->centre, posed[1] * glm::dvec3(0, 0, 0)) < 1e-9);
  // The pointer is on the ring that is parallel to the slice.
  const Ring ring = ring_of(view, test.editor->ui->look.scale, gizmo->centre, gizmo->axes[0], 86);
  point_at(view.pixel_of(ring.at(0.3)).value());
  test.host->events.push(ButtonChanged{MouseButton::Left, true});
  test.player.settle();
  for (int i = 1; i <= 9; ++i) point_at(view.pixel_of(ring.at(0.3 + i * kPi / 18)).value());
  test.host->events.push(ButtonChanged{MouseButton::Left, false});
  test.player.settle();
  CHECK(glm::degrees(swing_twist(pose_of(test.editor->document()).rotation[1], {1, 0, 0}).twist) ==
        doctest::Approx(90).epsilon(0.002));
}
