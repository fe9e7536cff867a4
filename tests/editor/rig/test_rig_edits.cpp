// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>

#include "core/motion/constraint.h"
#include "core/rig_io/rig_io.h"
#include "editor/context/interaction.h"
#include "editor/context/screen.h"
#include "editor/context/selection.h"
#include "editor/context/transform_settings.h"
#include "editor/context/view_projection.h"
#include "editor/files/import.h"
#include "editor/rig/joint_gizmo.h"
#include "editor/rig/rig_check.h"
#include "editor/rig/rig_edits.h"
#include "editor/ui/ui.h"
#include "editor/viewport/snap.h"
#include "tests/editor/small_limb.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::editor;
using limber::test::LimbEditor;
using limber::test::TemporaryFolder;

namespace {

struct RiggingEditor : LimbEditor {
  explicit RiggingEditor(const glm::ivec2& size = {900, 600}, double scale = 1) : LimbEditor(size, at_scale(scale)) {
    editor->preferences->reduce_motion = true;
    play("key Ctrl+1\nkey Num1\nkey Num5\nwait-idle");
    choose(1);
  }
  static Preferences at_scale(double scale) {
    Preferences preferences;
    preferences.scale = scale;
    return preferences;
  }
  void choose(int bone) {
    *editor->selection = {};
    editor->selection->bone = bone;
    editor->selection->bones = {bone};
  }
  ViewProjection view(ViewId id = ViewId::Body) const {
    return ViewProjection(*editor, {id, *editor->screen->layout.place_of(id)});
  }
  void drag(const ViewProjection& view, const glm::dvec3& from, const glm::dvec3& to) {
    pointer_to(view.pixel_of(from).value());
    host->events.push(ButtonChanged{MouseButton::Left, true});
    player.settle();
    pointer_to((view.pixel_of(from).value() + view.pixel_of(to).value()) / 2.0);
    pointer_to(view.pixel_of(to).value());
    host->events.push(ButtonChanged{MouseButton::Left, false});
    player.settle();
  }
  void pointer_to(const glm::dvec2& pixel) {
    const glm::dvec2 at = pixel / double(editor->ui->look.scale);
    play("move " + std::to_string(at.x) + " " + std::to_string(at.y));
  }
  const Armature& rig() const { return *editor->document().armature; }
};

}  // namespace

TEST_CASE("rigging: a joint is dragged in the 3D view and in a slice, and what is connected follows") {
  RiggingEditor test;
  test.editor->interaction->tool = Tool::Move;
  *test.editor->selection = {};
  test.drag(test.view(), {0, 0, -36}, {10, 0, -30});
  CHECK(test.editor->selection->bone == 1);
  CHECK(test.editor->transform_settings->part == TransformSettings::Part::Tail);
  CHECK(glm::distance(test.rig().bones[1].tail, glm::dvec3(10, 0, -30)) < 0.05);
  test.play("key Ctrl+Z\nclick view.split\nwait-idle");
  test.editor->views->cross_hair = {0, 0, 0};
  *test.editor->selection = {};
  test.play("wait-idle");
  const ViewId slice = test.editor->screen->layout.place_of(ViewId::Coronal) ? ViewId::Coronal : ViewId::Sagittal;
  const glm::dvec3 to = slice == ViewId::Coronal ? glm::dvec3(7, 0, 4) : glm::dvec3(0, 7, 4);
  test.drag(test.view(slice), {0, 0, 0}, to);
  CHECK(glm::distance(test.rig().bones[0].tail, to) < 0.1);
  CHECK(test.rig().bones[1].head == test.rig().bones[0].tail);
  test.play("key Ctrl+Z");
  CHECK(test.rig() == *limber::test::small_limb().armature);
}

TEST_CASE("rigging: Escape leaves the rig as it was, and an extrusion of no length makes no bone") {
  RiggingEditor test;
  const auto position = test.editor->history->position();
  test.play("move \"3D view/view\"\nkey E\nkey Z\nkey 9");
  CHECK(shown_rig(*test.editor)->bones.size() == 3);
  test.play("key Escape\nkey E\nkey Return");
  CHECK(test.rig().bones.size() == 2);
  CHECK(shown_rig(*test.editor)->bones.size() == 2);
  CHECK(test.editor->history->position() == position);
}

TEST_CASE("rigging: with Ctrl a joint snaps to steps, to another joint, or to the middle of the bone tissue below") {
  RiggingEditor test;
  test.play("move \"3D view/view\"\nkey G\nkey X\nkey-down Ctrl");
  test.pointer_to(glm::dvec2(test.editor->ui->input.pointer) + glm::dvec2(23, 0));
  test.play("key Return\nkey-up Ctrl");
  const double by = test.rig().bones[1].tail.x;
  CHECK(by > 1);
  CHECK(std::abs(by / 5 - std::round(by / 5)) < 1e-9);
  test.play("key Ctrl+Z");

  // The core of the ball is bone with a radius of 12 mm, around the origin.
  test.editor->transform_settings->snap = Snap::BoneMiddle;
  const ViewProjection view = test.view();
  const auto middle = middle_of_bone(test.editor->document(), view, view.pixel_of({3, 0, 4}).value());
  REQUIRE(middle);
  CHECK(glm::length(*middle) < 5);
  CHECK(!middle_of_bone(test.editor->document(), view, view.pixel_of({30, 0, 20}).value()));
}

TEST_CASE("rigging: pose, weights and names follow an edit, and come back with undo") {
  RiggingEditor test;
  Document next = test.editor->document();
  Pose pose = rest_pose(*next.armature);
  pose.rotation[1] = glm::angleAxis(0.5, glm::dvec3(1, 0, 0));
  next.pose = std::make_shared<const Pose>(pose);
  next.weights =
      std::make_shared<const SkinWeights>(std::vector<std::string>{"Upper", "Fore"}, TissueVoxels(*next.volume));
  test.editor->history->commit("Weights", next);

  next.clips = {
      std::make_shared<const Clip>(Clip{.name = "Keys", .keys = {.bones = {{"Fore", {{3, pose.rotation[1]}}}}}})};
  next.poses = {std::make_shared<const NamedPose>(NamedPose{"Bent", {{"Fore", pose.rotation[1]}}})};
  next.anchors = std::make_shared<const Anchors>(Anchors{.pins = {"Fore"}});
  test.editor->history->commit("Keys", next);

  rename_bone(*test.editor, 1, "Forearm");
  CHECK(test.editor->document().weights->bones()[1] == "Forearm");
  CHECK(test.editor->document().pose->rotation[1] == pose.rotation[1]);
  CHECK(test.editor->document().clips[0]->keys.bones.contains("Forearm"));
  CHECK(test.editor->document().poses[0]->rotation.contains("Forearm"));
  CHECK(test.editor->document().anchors->pins.contains("Forearm"));
  test.play("key Ctrl+Z");
  CHECK(test.editor->document() == next);
  test.play("key Ctrl+Shift+Z");
  // The weight of a removed bone goes to its parent. A root has no parent to take it.
  test.choose(1);
  test.play("move \"3D view/view\"\nkey X");
  CHECK(test.editor->document().weights->bones() == std::vector<std::string>{"Upper"});
  CHECK(test.editor->document().pose->rotation.size() == 1);
  test.play("key Ctrl+Z");
  CHECK(test.rig().bones[1].name == "Forearm");
  test.choose(0);
  test.play("key X");
  CHECK(test.editor->document().weights == nullptr);
  CHECK(test.fact("toast") != "none");
  test.play("key Ctrl+Z");
  CHECK(test.editor->document().weights);
}

TEST_CASE("rigging: the sidebar's numbers move ends, lengthen and roll, and F2 renames in the outliner") {
  RiggingEditor test({1240, 700});
  test.play("double-click \"Bone/Tail X\"\nkey Ctrl+A\ntype \"4\"\nkey Return\nwait-idle");
  CHECK(test.rig().bones[1].tail.x == doctest::Approx(4));
  test.play("move \"3D view/view\"\nkey F2\nkey Ctrl+A\ntype \"Lower\"\nkey Return\nwait-idle");
  CHECK(test.rig().bones[1].name == "Lower");
}

TEST_CASE("rigging: the sidebar sets what a joint allows, one edit each, and rest stays allowed") {
  RiggingEditor test({1280, 900});
  test.play("click Steps/fold\n click Outliner/fold\n click Tissues/fold\n wait-idle\n click Joint/fold\n wait-idle");
  const auto limits = [&] { return test.rig().bones[1].limits; };
  test.play("click Joint/Kind/list\n click Joint/Kind/Ball\n wait-idle\n expect edit \"Set limits of Fore\"");
  CHECK(limits().type == JointLimits::Type::Ball);
  test.play(
      "double-click Joint/Cone\n type \"30\"\n key Return\n double-click \"Joint/Twist from\"\n type \"-200\"\n key "
      "Return");
  CHECK(glm::degrees(limits().cone) == doctest::Approx(30));
  CHECK(glm::degrees(limits().twist_minimum) == doctest::Approx(-180));
  test.play(
      "click Joint/Kind/list\n click Joint/Kind/Hinge\n wait-idle\n click Joint/Axis/list\n click \"Joint/Axis/Local "
      "Z\"");
  CHECK(limits().axis == rest_axes(test.rig().bones[1])[2]);
  // A range must contain the rest pose, so its lower end is not above zero.
  test.play(
      "double-click \"Joint/Angle from\"\n type \"20\"\n key Return\n double-click \"Joint/Angle to\"\n type \"140\"\n "
      "key Return");
  CHECK(limits().minimum == 0);
  CHECK(glm::degrees(limits().maximum) == doctest::Approx(140));
  test.play("key Ctrl+Z\n key Ctrl+Z\n key Ctrl+Z\n key Ctrl+Z");
  CHECK(limits().type == JointLimits::Type::Ball);
}

TEST_CASE("rigging: the fit check follows a joint that is dragged out of the tissue, and a click goes there") {
  for (const double scale : {1.0, 2.0}) {
    RiggingEditor test(scale > 1 ? glm::ivec2(2480, 1500) : glm::ivec2(1240, 750), scale);
    test.play(
        "click Steps/fold\n click Outliner/fold\n click Tissues/fold\n wait-idle\n click \"Fit check/fold\"\n "
        "wait-idle");
    REQUIRE(rig_check(*test.editor));
    CHECK(rig_check(*test.editor)->bones.empty());
    CHECK(test.fact("text:All in tissue") == "shown");
    // The bone, 72 mm long with its new tail, starts at the middle of a ball of tissue with a radius of 40 mm: 40 / 72
    // of it is in tissue. The fit check says so while the tail moves, and lists no bone after Escape.
    test.editor->transform_settings->part = TransformSettings::Part::Tail;
    test.play("move \"3D view/view\"\n key G\n key Z\n key -\n key 3\n key 6");
    CHECK(rig_check(*test.editor)->bones[0].share == doctest::Approx(40.0 / 72).epsilon(0.03));
    CHECK(test.fact("text:tail") == "shown");
    test.play("key Escape\n wait-idle");
    CHECK(rig_check(*test.editor)->bones.empty());
    test.play("key G\n key Z\n key -\n key 3\n key 6\n key Return\n wait-idle");
    *test.editor->selection = {};
    test.play("click \"Fit check/Fore/name\"\n wait-idle\n wait 1");
    CHECK(test.editor->selection->bone == 1);
    CHECK(test.editor->transform_settings->part == TransformSettings::Part::Tail);
    CHECK(glm::distance(test.editor->views->body.camera.centre, glm::dvec3(0, 0, -72)) < 1e-6);
    test.play("key Ctrl+Z\n wait-idle");
    CHECK(rig_check(*test.editor)->bones.empty());
  }
}

TEST_CASE(
    "rigging: a joint that is dragged with Ctrl snaps to a voxel, a joint or the middle of bone, in 3D and in a "
    "slice") {
  for (const double scale : {1.0, 2.0})
    for (const ViewId id : {ViewId::Body, ViewId::Coronal}) {
      RiggingEditor test(scale > 1 ? glm::ivec2(1800, 1200) : glm::ivec2(900, 600), scale);
      INFO("scale ", scale, ", view ", name_of(id));
      test.editor->interaction->tool = Tool::Move;
      test.editor->views->cross_hair = {0, 0, 0};
      if (id != ViewId::Body) test.play("click view.four\nwait-idle");
      const auto snapped = [&](Snap snap, const glm::dvec3& to) {
        test.editor->transform_settings->snap = snap;
        *test.editor->selection = {};
        test.pointer_to(test.view(id).pixel_of({0, 0, -36}).value());
        test.host->events.push(ButtonChanged{MouseButton::Left, true});
        test.player.settle();
        test.play("key-down Ctrl");
        test.pointer_to(test.view(id).pixel_of({5, 0, -30}).value());
        test.pointer_to(test.view(id).pixel_of(to).value());
        test.host->events.push(ButtonChanged{MouseButton::Left, false});
        test.player.settle();
        test.play("key-up Ctrl");
        const glm::dvec3 place = test.rig().bones[1].tail;
        test.play("key Ctrl+Z\nwait-idle");
        CHECK(test.rig() == *limber::test::small_limb().armature);
        return place;
      };
      const AffineTransform voxel = voxel_from_world(test.editor->document().volume->grid);
      const glm::dvec3 at = voxel * snapped(Snap::Voxel, {13.3, 0, -21.2});
      CHECK(glm::length(at - glm::round(at)) < 1e-9);
      CHECK(glm::distance(at, voxel * glm::dvec3(13.3, 0, -21.2)) < 1);
      CHECK(glm::distance(snapped(Snap::Joint, {1, 0, 35}), {0, 0, 36}) < 1e-9);
      CHECK(glm::length(snapped(Snap::BoneMiddle, {4, 0, -4})) < 5);
    }
}

namespace {

// Gives the trunk an arm on each side.
void give_two_arms(RiggingEditor& test) {
  Document next = test.editor->document();
  Armature rig;
  rig.bones = {{"Trunk", -1, {0, 0, -30}, {0, 0, 0}, 0, {}},
               {"Arm.L", 0, {4, 0, 0}, {20, 0, 4}, 0, {}},
               {"Arm.R", 0, {-4, 0, 0}, {-20, 0, 4}, 0, {}}};
  next.armature = std::make_shared<const Armature>(rig);
  test.editor->history->commit("Arms", next);
  test.choose(1);
  test.play("wait-idle");
}

}  // namespace

TEST_CASE("rigging: with X-mirror both sides extrude") {
  RiggingEditor test;
  give_two_arms(test);
  test.editor->transform_settings->x_mirror = true;
  test.editor->transform_settings->part = TransformSettings::Part::Tail;
  test.play("move \"3D view/view\"\n key E\n key X\n key 9");
  CHECK(shown_rig(*test.editor)->bones.size() == 5);
  test.play("key Return\n wait-idle");
  REQUIRE(test.rig().bones.size() == 5);
  CHECK(test.rig().bones[3].name == "Arm.L.001");
  CHECK(test.rig().bones[4].name == "Arm.R.001");
  CHECK(test.rig().bones[4].parent == 2);
  CHECK(glm::distance(test.rig().bones[3].tail, {29, 0, 4}) < 1e-9);
  CHECK(glm::distance(test.rig().bones[4].tail, {-29, 0, 4}) < 1e-9);
  CHECK(test.editor->selection->bones == std::set<int>{3});
  test.play("key Ctrl+Z");
  CHECK(test.rig().bones.size() == 3);
}

TEST_CASE("rigging: a bone mirrored to the other side keeps its weights and pose, and does in the mirror what it did") {
  RiggingEditor test;
  give_two_arms(test);
  test.play("key Ctrl+1\n wait-idle");
  test.choose(test.rig().find("Arm.R").value());
  test.play("move \"3D view/view\"\n key X");
  Document next = test.editor->document();
  const int arm = next.armature->find("Arm.L").value();
  const glm::dquat raised = glm::angleAxis(0.4, glm::normalize(glm::dvec3(1, 2, 3))),
                   in_the_mirror = glm::angleAxis(-0.4, glm::normalize(glm::dvec3(-1, 2, 3)));
  Pose pose = rest_pose(*next.armature);
  pose.rotation[arm] = raised;
  next.pose = std::make_shared<const Pose>(pose);
  const auto in_voxels = [&](const SkinWeights& weights) {
    std::string all;
    for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick)
      for (const Influence& influence : weights.chunk(brick)) all += std::to_string(influence.bone[0]) + " ";
    return all;
  };
  auto weights = std::make_shared<SkinWeights>(std::vector<std::string>{"Trunk", "Arm.L"}, TissueVoxels(*next.volume));
  next.weights = weights;
  next.clips = {std::make_shared<const Clip>(Clip{.name = "Keys", .keys = {.bones = {{"Arm.L", {{3, raised}}}}}})};
  next.poses = {std::make_shared<const NamedPose>(NamedPose{"Raised", {{"Arm.L", raised}}})};
  next.anchors = std::make_shared<const Anchors>(Anchors{.pins = {"Arm.L"}, .poles = {{"Arm.L", {7, 8, 9}}}});
  test.editor->history->commit("Weights and keys", next);

  test.choose(arm);
  test.play("move \"3D view/view\"\n key Ctrl+M");
  const Document& document = test.editor->document();
  REQUIRE(test.rig().bones[arm].name == "Arm.R");
  CHECK(test.rig().bones[arm].tail.x == -next.armature->bones[arm].tail.x);
  REQUIRE(document.weights);
  CHECK(document.weights->bones() == std::vector<std::string>{"Trunk", "Arm.R"});
  CHECK(in_voxels(*document.weights) == in_voxels(*weights));
  const auto same = [](const glm::dquat& a, const glm::dquat& b) { return std::abs(glm::dot(a, b)) > 1 - 1e-12; };
  CHECK(same(document.pose->rotation[arm], in_the_mirror));
  CHECK(same(document.clips[0]->keys.bones.at("Arm.R").at(3), in_the_mirror));
  CHECK(!document.clips[0]->keys.bones.contains("Arm.L"));
  CHECK(same(document.poses[0]->rotation.at("Arm.R"), in_the_mirror));
  CHECK(document.anchors->pins == std::set<std::string>{"Arm.R"});
  // The pole is mirrored at the trunk, which lies in the middle.
  CHECK(glm::distance(document.anchors->poles.at("Arm.R"), {-7, 8, 9}) < 1e-9);
  CHECK(test.editor->selection->bones == std::set<int>{arm});

  // Mirroring again restores the rig.
  test.play("key Ctrl+M");
  CHECK(test.rig() == *next.armature);
  CHECK(same(test.editor->document().pose->rotation[arm], raised));
  CHECK(*test.editor->document().anchors == *next.anchors);
}

TEST_CASE(
    "rigging: the two bones of a pair that are mirrored change places, and what belongs to each side stays there") {
  RiggingEditor test;
  give_two_arms(test);
  Document next = test.editor->document();
  const glm::dquat raised = glm::angleAxis(0.4, glm::dvec3(0, 1, 0));
  next.clips = {std::make_shared<const Clip>(Clip{.name = "Keys", .keys = {.bones = {{"Arm.L", {{3, raised}}}}}})};
  next.weights = std::make_shared<const SkinWeights>(std::vector<std::string>{"Trunk", "Arm.L", "Arm.R"},
                                                     TissueVoxels(*next.volume));
  test.editor->history->commit("Keys", next);
  test.choose(1);
  test.editor->selection->bones = {1, 2};
  test.play("move \"3D view/view\"\n key Ctrl+M");
  CHECK(test.rig().bones[test.rig().find("Arm.L").value()].tail.x > 0);
  CHECK(test.editor->document().clips == next.clips);
  CHECK(test.editor->document().weights->bones()[test.rig().find("Arm.L").value()] == "Arm.L");
  CHECK(test.editor->selection->bones == std::set<int>{1, 2});
}

TEST_CASE("rigging: with X-mirror both sides change parents, and are deleted, each on its side") {
  RiggingEditor test;
  give_two_arms(test);
  Document next = test.editor->document();
  Armature rig = *next.armature;
  for (const double side : {1.0, -1.0})
    rig.bones.push_back({side > 0 ? "Hand.L" : "Hand.R", 0, {side * 24, 0, 4}, {side * 30, 0, 4}, 0, {}});
  next.armature = std::make_shared<const Armature>(rig);
  test.editor->history->commit("Hands", next);
  test.editor->transform_settings->x_mirror = true;
  const auto parent_of = [&](const std::string& name) {
    const int parent = test.rig().bones[test.rig().find(name).value()].parent;
    return parent < 0 ? std::string() : test.rig().bones[parent].name;
  };
  // Selects a child, and its future parent as the active bone.
  const auto choose_both = [&](const std::string& child, const std::string& parent) {
    test.choose(test.rig().find(parent).value());
    test.editor->selection->bones.insert(test.rig().find(child).value());
    test.play("move \"3D view/view\"");
  };
  choose_both("Hand.L", "Arm.L");
  test.play("key Ctrl+P");
  CHECK(parent_of("Hand.L") == "Arm.L");
  CHECK(parent_of("Hand.R") == "Arm.R");
  test.play("key Ctrl+Z\n wait-idle");
  CHECK(parent_of("Hand.R") == "Trunk");
  choose_both("Hand.L", "Arm.L");
  test.play("click \"Edit/Bone/Connect to parent\"");
  CHECK(glm::distance(test.rig().bones[test.rig().find("Hand.R").value()].head, {-20, 0, 4}) < 1e-9);
  // With a parent on the other side, the mirrored bone gets the mirrored parent, unless this is the bone itself.
  choose_both("Hand.L", "Arm.R");
  test.play("key Ctrl+P");
  CHECK(parent_of("Hand.L") == "Arm.R");
  CHECK(parent_of("Hand.R") == "Arm.L");
  choose_both("Arm.L", "Arm.R");
  test.play("key Ctrl+P");
  CHECK(parent_of("Arm.L") == "Arm.R");
  CHECK(parent_of("Arm.R") == "Trunk");
  test.play("key Ctrl+Z\n key Alt+P\n wait-idle");
  test.choose(test.rig().find("Hand.L").value());
  test.play("move \"3D view/view\"\n key X");
  CHECK(test.rig().bones.size() == 3);
}

TEST_CASE("rigging: a bone's row is dragged onto its new parent, and onto the armature to be free") {
  for (const double scale : {1.0, 2.0}) {
    RiggingEditor test(scale > 1 ? glm::ivec2(2480, 1500) : glm::ivec2(1240, 750), scale);
    give_two_arms(test);
    const auto parent_of = [&](const std::string& name) {
      const int parent = test.rig().bones[test.rig().find(name).value()].parent;
      return parent < 0 ? std::string() : test.rig().bones[parent].name;
    };
    test.play(
        "press \"Outliner/bone Arm.L/name\"\n move \"Outliner/bone Trunk/name\"\n move \"Outliner/bone Arm.R/name\"\n "
        "release\n wait-idle\n expect edit \"Parent Arm.L to Arm.R\"");
    CHECK(parent_of("Arm.L") == "Arm.R");
    CHECK(parent_of("Arm.R") == "Trunk");
    // A bone cannot become the child of its own child. Escape changes nothing.
    test.play("press \"Outliner/bone Arm.R/name\"\n move \"Outliner/bone Arm.L/name\"\n release\n wait-idle");
    CHECK(test.fact("error") != "none");
    test.play(
        "key Escape\n press \"Outliner/bone Arm.L/name\"\n move \"Outliner/bone Trunk/name\"\n key Escape\n release\n "
        "wait-idle");
    CHECK(parent_of("Arm.L") == "Arm.R");
    test.play("press \"Outliner/bone Arm.L/name\"\n move \"Outliner/armature/name\"\n release\n wait-idle");
    CHECK(parent_of("Arm.L").empty());
    test.play("key Ctrl+Z\n key Ctrl+Z");
    CHECK(parent_of("Arm.L") == "Trunk");
  }
}

TEST_CASE("rigging: the axis of a hinge is drawn by its handle, and a knob rolls the bone") {
  for (const double scale : {1.0, 2.0}) {
    RiggingEditor test(scale > 1 ? glm::ivec2(1800, 1200) : glm::ivec2(900, 600), scale);
    INFO("scale ", scale);
    test.editor->interaction->tool = Tool::Rotate;
    test.player.settle();
    const ViewProjection view = test.view();
    const glm::dvec3 head = test.rig().bones[1].head, handle = hinge_handle(*test.editor, view).value();
    CHECK(glm::distance(glm::normalize(handle - head), {1, 0, 0}) < 1e-9);
    // Drags the handle from the x axis by 30 degrees towards z, in the plane of the front view.
    const double reach = glm::distance(handle, head);
    const glm::dvec3 to = head + reach * glm::dvec3(std::cos(glm::radians(30.0)), 0, std::sin(glm::radians(30.0)));
    test.drag(view, handle, to);
    test.play("expect edit \"Set hinge of Fore\"");
    const glm::dvec3 axis = test.rig().bones[1].limits.axis;
    CHECK(glm::degrees(std::acos(std::min(1.0, glm::dot(axis, glm::normalize(to - head))))) < 0.1);
    test.play("key Ctrl+Z");
    CHECK(test.rig() == *limber::test::small_limb().armature);

    const auto press_at = [&](const glm::dvec3& point) {
      test.pointer_to(view.pixel_of(point).value());
      test.host->events.push(ButtonChanged{MouseButton::Left, true});
      test.player.settle();
    };
    const auto release = [&] {
      test.host->events.push(ButtonChanged{MouseButton::Left, false});
      test.player.settle();
    };
    // Ctrl snaps to the nearest of the bone's own axes, a letter selects a world axis, and Escape restores the old
    // axis.
    press_at(handle);
    test.play("key-down Ctrl");
    test.pointer_to(view.pixel_of(head + reach * glm::dvec3(0.2, 0, 1)).value());
    CHECK(std::abs(shown_rig(*test.editor)->bones[1].limits.axis.z) == doctest::Approx(1));
    test.play("key-up Ctrl\n key Y");
    CHECK(std::abs(shown_rig(*test.editor)->bones[1].limits.axis.y) == doctest::Approx(1));
    test.play("key Escape");
    release();
    CHECK(test.rig() == *limber::test::small_limb().armature);

    // A typed angle turns the hinge axis about the line of sight. After the key Z it turns the axis about z instead.
    press_at(handle);
    test.play("key 3\n key 0");
    CHECK(glm::distance(shown_rig(*test.editor)->bones[1].limits.axis,
                        glm::angleAxis(glm::radians(30.0), view.towards_eye) * glm::dvec3(1, 0, 0)) < 1e-9);
    test.play("key Z");
    CHECK(glm::distance(shown_rig(*test.editor)->bones[1].limits.axis,
                        {std::cos(glm::radians(30.0)), std::sin(glm::radians(30.0)), 0}) < 1e-9);
    test.play("key Return");
    release();
    test.play("expect edit \"Set hinge of Fore\"\n key Ctrl+Z");
    CHECK(test.rig() == *limber::test::small_limb().armature);

    // Tests the knob that rolls the bone, with a typed angle and with Escape.
    press_at(roll_handle(*test.editor, view).value());
    test.play("key 4\n key 0\n key Return");
    release();
    CHECK(glm::degrees(test.rig().bones[1].roll) == doctest::Approx(40));
    test.play("expect edit \"Roll Fore\"\n key Ctrl+Z");
    press_at(roll_handle(*test.editor, view).value());
    test.play("key 4\n key Escape");
    release();
    CHECK(test.rig() == *limber::test::small_limb().armature);
  }
}

TEST_CASE("rigging: name, parent and connection are changed in the sidebar") {
  RiggingEditor test({1280, 720});
  test.play("click Bone/Name\n key Ctrl+A\n type \"Lower\"\n key Return\n wait-idle");
  CHECK(test.rig().bones[1].name == "Lower");
  test.play("click Bone/Connected\n wait-idle\n expect edit \"Disconnect Lower\"");
  CHECK_FALSE(is_connected(test.rig(), 1));
  CHECK(test.rig().bones[1].head.z == doctest::Approx(-1.8));
  test.play("click Bone/Connected\n wait-idle\n expect edit \"Connect Lower\"");
  CHECK(is_connected(test.rig(), 1));
  test.play("click Bone/Parent/list\n click Parent/None\n wait-idle");
  CHECK(test.rig().bones[1].parent == -1);
  test.play("click Bone/Parent/list\n click Parent/Upper\n wait-idle\n expect edit \"Parent Lower to Upper\"");
  CHECK(test.rig().bones[1].parent == 0);
}

TEST_CASE("rigging: a bone of no length is refused with a line, typed in the sidebar or scaled") {
  RiggingEditor test({1280, 720});
  const Armature before = test.rig();
  for (const char* deed : {"double-click Bone/Length\n key Ctrl+A\n type \"0\"\n key Return",
                           "move \"3D view/view\"\n key S\n key 0\n key Return"}) {
    INFO(std::string(deed));
    const std::size_t lines = test.editor->messages->log.size();
    test.play(deed);
    test.play("wait-idle");
    CHECK(test.rig() == before);
    CHECK(test.editor->messages->log.size() == lines + 1);
    CHECK_FALSE(test.editor->views->preview_armature);
  }
}

TEST_CASE("rigging: undo of a deletion chooses the bones again, and what is symmetrized without a side says why not") {
  RiggingEditor test({1280, 720});
  test.play("move \"3D view/view\"\n key X\n wait-idle");
  REQUIRE(test.rig().bones.size() == 1);
  test.play("key Ctrl+Z\n wait-idle");
  CHECK(test.editor->selection->bone == 1);
  CHECK(test.editor->selection->bones == std::set<int>{1});
  const Armature before = test.rig();
  test.play("move \"3D view/view\"\n key Shift+M\n wait-idle");
  CHECK(test.rig() == before);
  REQUIRE(test.editor->messages->errors.size() == 1);
  CHECK(test.editor->messages->errors[0].where == "Fore");
}

TEST_CASE(
    "rigging: however many bones there are, choosing one shows it in the outliner and its numbers below, without "
    "scrolling") {
  for (const double scale : {1.0, 2.0}) {
    RiggingEditor test(scale > 1 ? glm::ivec2(2560, 1440) : glm::ivec2(1280, 720), scale);
    Document chain = test.editor->document();
    auto rig = std::make_shared<Armature>();
    for (int b = 0; b < 40; ++b)
      rig->bones.push_back({"B" + std::to_string(b), b % 10 ? b - 1 : -1, {b, 0, 0}, {b, 0, 5}});
    chain.armature = rig;
    test.editor->history->reset(chain, "Open chains");
    test.play("click Steps/fold\n wait-idle");
    for (const int bone : {39, 0, 25}) {
      INFO("bone ", bone, ", scale ", scale);
      test.choose(bone);
      test.play("wait-idle");
      const Rect& sidebar = test.editor->screen->layout.sidebar;
      const Widget* row = test.editor->ui->widgets.find("Outliner/bone B" + std::to_string(bone) + "/name");
      REQUIRE(row);
      CHECK(row->rect.height() >= 20 * scale);
      for (const char* field : {"Bone/Name", "Bone/Head X", "Bone/Tail Z", "Bone/Length", "Bone/Roll"}) {
        const Widget* widget = test.editor->ui->widgets.find(field);
        REQUIRE(widget);
        CHECK(sidebar.contains(widget->rect));
        CHECK(widget->rect.height() >= 21 * scale);
      }
    }
  }
}

TEST_CASE("rigging: an edit that moves the target bone of a constraint says so, and others say nothing") {
  RiggingEditor test;
  Document document = test.editor->document();
  const std::string child = test.rig().bones[1].name, root = test.rig().bones[0].name;
  Clip clip{.name = "sit", .range_end = 10};
  clip.constraints = std::make_shared<const Constraints>(
      Constraints{{{.name = "Aim", .kind = ConstraintKind::Aim, .bone = root, .target = child, .place{0, 0, 9}},
                   {.name = "Copy", .kind = ConstraintKind::CopyRotation, .bone = root, .target = child},
                   {.name = "Free", .kind = ConstraintKind::Aim, .bone = child, .place{0, 0, 9}}}});
  document.clips = {std::make_shared<const Clip>(clip)};
  test.editor->history->reset(document, "Open limb");
  const auto warnings = [&] {
    std::string all;
    for (const LogLine& line : test.editor->messages->log)
      if (line.severity == Severity::Warning) all += line.text + "\n";
    return all;
  };
  Armature limits = test.rig();
  limits.bones[1].roll += 0.1;
  commit_rig(*test.editor, "Roll", limits, {1});
  CHECK(warnings() == "");
  rename_bone(*test.editor, 1, "Other");
  CHECK(warnings() == "");
  Armature moved = test.rig();
  moved.bones[1].tail.x += 5;
  commit_rig(*test.editor, "Move tail", moved, {1});
  CHECK(warnings().find("Aim (sit)") != std::string::npos);
  CHECK(warnings().find("Free") == std::string::npos);
  CHECK(warnings().find("Copy") == std::string::npos);  // copying a rotation does not depend on the bone's position
  // Imports a rig over the current one.
  const TemporaryFolder folder;
  write_armature(test.rig(), folder / "same.json");
  moved.bones[1].tail.x += 5;
  moved.bones[1].name = test.rig().bones[1].name;
  write_armature(moved, folder / "other.json");
  import_file(*test.editor, FileKind::Rig, folder / "same.json");
  test.play("wait-job\n wait-idle");
  CHECK(warnings().find("Import same.json") == std::string::npos);
  import_file(*test.editor, FileKind::Rig, folder / "other.json");
  test.play("wait-job\n wait-idle");
  CHECK(warnings().find("Import other.json: targets of constraints moved") != std::string::npos);
}
