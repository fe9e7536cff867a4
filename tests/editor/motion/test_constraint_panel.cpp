// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests each operator of constraints, and tests what the panel does to the shown clip.
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/motion/constraint_edits.h"

#include "core/project/project_io.h"
#include "editor/files/view_state_json.h"
#include "editor/motion/constrained_pose.h"
#include "editor/pose/pose_edits.h"
#include "editor/shown/shown_pose.h"
#include "tests/editor/motion/constrained_arm.h"
#include "tests/editor/operator_proofs.h"

namespace limber::test {

using namespace editor;

namespace {

std::function<void(Stage&)> ready(std::vector<Constraint> constraints, int bone = kHand,
                                  std::optional<int> target = {}) {
  return [=](Stage& s) {
    open_arm(s.editor(), constraints, bone, target);
    s.play("key Ctrl+3\n wait-idle");
  };
}

const std::vector<Constraint>& list_of(Stage& stage) { return constraints_of(stage.document()).list; }

// Two constraints that aim one arm at different positions. The later one determines the result.
std::vector<Constraint> two_aims() {
  return {{.name = "A", .kind = ConstraintKind::Aim, .bone = "LeftArm", .place{90, 0, 0}},
          {.name = "B", .kind = ConstraintKind::Aim, .bone = "LeftArm", .place{0, 0, -90}}};
}
std::function<void(Stage&)> ready_two(const std::string& active) {
  return [=](Stage& s) {
    ready(two_aims(), kUpper)(s);
    s.editor().timeline->constraint = active;
  };
}
std::function<bool(Stage&, const Seen&)> in_order(const std::string& first, const std::string& edit) {
  return [=](Stage& s, const Seen&) {
    return list_of(s)[0].name == first && list_of(s).size() == 2 && s.is("edit", edit);
  };
}

std::function<bool(Stage&, const Seen&)> has_one(ConstraintKind kind, const std::string& bone,
                                                 const std::string& target) {
  return [=](Stage& s, const Seen&) {
    return list_of(s).size() == 1 && list_of(s)[0].kind == kind && list_of(s)[0].bone == bone &&
           list_of(s)[0].target == target && s.editor().timeline->constraint == list_of(s)[0].name;
  };
}

}  // namespace

std::vector<Proof> proofs_of_constraints() {
  const auto choose = [](const char* label) {
    return std::string("click \"Motion/Constraints/") + label + "\"\n wait-idle";
  };
  const std::vector<Constraint> one{planted_hand()};
  return {
      {"constraint.add", "click Constraints/constraint.add\n wait-idle",
       [](Stage& s, const Seen&) { return s.editor().menus->shown_popup == "Add constraint"; }, Shows::Nothing, "",
       ready({})},
      {"constraint.add_copy_rotation", choose("Add copy rotation"),
       has_one(ConstraintKind::CopyRotation, "LeftHand", "LeftThigh"), Shows::Nothing, "", ready({}, kHand, kThigh)},
      {"constraint.add_limit_rotation", choose("Add limit rotation"),
       has_one(ConstraintKind::LimitRotation, "LeftHand", ""), Shows::Nothing, "", ready({})},
      {"constraint.add_joint_range", choose("Add joint range"), has_one(ConstraintKind::JointRange, "LeftArm", ""),
       Shows::Nothing, "", ready({}, kUpper)},
      {"constraint.add_aim", choose("Add aim"), has_one(ConstraintKind::Aim, "LeftForeArm", "LeftThigh"), Shows::InBody,
       "", ready({}, kFore, kThigh)},
      {"constraint.add_plant", choose("Add plant"), has_one(ConstraintKind::Plant, "LeftHand", ""), Shows::Nothing, "",
       ready({})},
      {"constraint.add_inverse_kinematics", choose("Add inverse kinematics"),
       has_one(ConstraintKind::InverseKinematics, "LeftHand", "LeftThigh"), Shows::Nothing, "",
       ready({}, kHand, kThigh)},
      {"constraint.toggle", choose("Toggle constraint"),
       [](Stage& s, const Seen&) { return !list_of(s)[0].on && s.is("edit", "Switch constraint off"); }, Shows::InBody,
       "", ready(one)},
      {"constraint.up", choose("Move constraint up"), in_order("B", "Move constraint up"), Shows::InBody, "",
       ready_two("B")},
      {"constraint.down", choose("Move constraint down"), in_order("B", "Move constraint down"), Shows::InBody, "",
       ready_two("A")},
      {"constraint.key_weight", choose("Key constraint weight"),
       [](Stage& s, const Seen&) {
         return weights(s.editor()) == std::map<int, double>{{10, 1}};
       },
       Shows::Nothing, "", ready(one)},
      {"constraint.switch", choose("Switch IK and FK"),
       [](Stage& s, const Seen&) {
         return weights(s.editor()) == std::map<int, double>{{10, 1}, {20, 0}};
       },
       Shows::Nothing, "", ready(one)},
      {"constraint.to_cross_hair", choose("Target to cross-hair"),
       [](Stage& s, const Seen&) {
         const Constraint& aim = list_of(s)[0];
         return glm::distance(aim.place, s.editor().views->cross_hair) < 1e-9 && s.is("edit", "Target to cross-hair");
       },
       Shows::InBody, "",
       [](Stage& s) {
         ready({{.name = "Aim", .kind = ConstraintKind::Aim, .bone = "LeftArm", .place{90, 0, 0}}}, kUpper)(s);
         s.editor().views->cross_hair = {-20, -30, -10};
       }},
      {"constraint.remove", choose("Remove constraint"),
       [](Stage& s, const Seen&) { return list_of(s).empty() && s.is("edit", "Remove constraint"); }, Shows::InBody, "",
       ready(one)},
      {"constraint.apply", choose("Apply constraints") + "\n wait-job\n wait-idle",
       [](Stage& s, const Seen&) {
         return list_of(s).empty() && shown_clip(s.editor().document())->keys.bones.contains("LeftHand") &&
                shown_clip(s.editor().document())->keys.bones.at("LeftHand").size() == 31;
       },
       Shows::Nothing, "", ready(one)},
  };
}

TEST_CASE("operators: bones are constrained") {
  Stage stage;
  prove(stage, proofs_of_constraints());
}

TEST_CASE("constraint panel: a planted hand stays where it was when it is planted, and on its bone in every frame") {
  ArmEditor test({}, kHand, kThigh);
  const glm::dvec3 before = tail_of(test.document(), kHand);
  test.play("click Constraints/constraint.add\n wait-idle\n click \"Add constraint/Add plant\"\n wait-idle");
  REQUIRE(constraints_of(test.document()).list.size() == 1);
  CHECK(glm::distance(tail_of(test.document(), kHand), before) < 0.01);
  CHECK(glm::distance(test.place(), before) < 1e-6);
  const Pose planted = pose_of(test.document());
  for (const int frame : {0, 25, 30}) {
    go_to_frame(*test.editor, frame);
    CHECK(glm::distance(tail_of(test.document(), kHand), test.place()) < 0.01);
    // Playing gives the same pose as going to the frame.
    CHECK(pose_of(test.document()) == clip_on_rig(*test.editor)->at(frame));
  }
  CHECK(glm::distance(tail_of(test.document(), kHand), before) > 5);
  test.play("key Ctrl+Z\n key Ctrl+Z\n wait-idle");
  CHECK(constraints_of(test.document()).list.empty());
  test.play("key Ctrl+Shift+Z\n wait-idle");
  CHECK(pose_of(test.document()) == planted);
}

TEST_CASE("constraint panel: the weight is slid, keyed and unkeyed, each as one edit") {
  ArmEditor test({planted_hand()});
  const std::string path = "\"Constraints/Plant LeftHand/";
  test.play("click " + path + "Fold\"\n wait-idle");
  const std::size_t steps = test.editor->history->steps().size();
  const Pose full = pose_of(test.document());
  test.play("double-click " + path + "Plant LeftHand weight\"\n key Ctrl+A\n type 0.25\n key Return\n wait-idle");
  CHECK(constraints_of(test.document()).list[0].weight == 0.25);
  CHECK(test.editor->history->steps().size() == steps + 1);
  CHECK(pose_of(test.document()) != full);
  test.play("click " + path + "Key weight\"\n wait-idle");
  CHECK(weights(*test.editor) == std::map<int, double>{{10, 0.25}});
  go_to_frame(*test.editor, 20);
  test.play("wait-idle\n double-click " + path +
            "Plant LeftHand weight\"\n key Ctrl+A\n type 1\n key Return\n wait-idle");
  CHECK(weights(*test.editor) == std::map<int, double>{{10, 0.25}, {20, 1}});
  CHECK(shown_weight(*test.editor, constraints_of(test.document()).list[0]) == 1);
  go_to_frame(*test.editor, 15);
  CHECK(shown_weight(*test.editor, constraints_of(test.document()).list[0]) == doctest::Approx(0.625));
  // The keys of the weight appear in the timeline too.
  CHECK(frames_of(shown_clip(test.editor->document())->keys).contains(20));
  go_to_frame(*test.editor, 20);
  test.play("wait-idle\n click " + path + "Key weight\"\n wait-idle");
  CHECK(weights(*test.editor) == std::map<int, double>{{10, 0.25}});
  go_to_frame(*test.editor, 10);
  test.play("wait-idle\n click " + path + "Key weight\"\n wait-idle");
  CHECK(weights(*test.editor).empty());
  CHECK(constraints_of(test.document()).list[0].weight == 0.25);
}

TEST_CASE("constraint panel: keys inserted where a constraint counts by half do not make it count twice") {
  ArmEditor test({planted_hand(0.5)});
  const Pose shown = pose_of(test.document());
  for (int time = 0; time < 3; ++time) {
    run(*test.editor, "select.all");
    run(*test.editor, "motion.insert_key");
    for (int bone = 0; bone < 5; ++bone)
      CHECK(std::abs(glm::dot(pose_of(test.document()).rotation[bone], shown.rotation[bone])) > 1 - 1e-12);
  }
  // The constraint is applied by half on top of a rotation by the user, before and after keys are inserted.
  Pose raised = shown;
  raised.rotation[kUpper] = glm::angleAxis(0.7, glm::dvec3(0, 1, 0)) * shown.rotation[kUpper];
  commit_pose(*test.editor, "Raise", raised);
  const Pose held = pose_of(test.document());
  CHECK(held != shown);
  run(*test.editor, "motion.insert_key");
  for (int bone = 0; bone < 5; ++bone)
    CHECK(std::abs(glm::dot(pose_of(test.document()).rotation[bone], held.rotation[bone])) > 1 - 1e-12);
  // Undo restores the pose from before the edit, both as it is shown and as it is without the constraint.
  run(*test.editor, "edit.undo");
  run(*test.editor, "edit.undo");
  CHECK(pose_of(test.document()).rotation[kTrunk] == shown.rotation[kTrunk]);
  run(*test.editor, "edit.redo");
  run(*test.editor, "motion.insert_key");
  for (int bone = 0; bone < 5; ++bone)
    CHECK(std::abs(glm::dot(pose_of(test.document()).rotation[bone], held.rotation[bone])) > 1 - 1e-12);
}

TEST_CASE("constraint panel: poses that a constraint makes alike in two frames keep what lies below each of them") {
  Constraint stiff{.name = "Stiff", .kind = ConstraintKind::LimitRotation, .bone = "Trunk"};
  stiff.minimum = stiff.maximum = glm::dvec3(0);
  ArmEditor test({stiff}, kTrunk);
  edit_clip(*test.editor, "Still arm", PoseThen::FromClip, [](Clip& clip) { clip.keys.bones.erase("LeftArm"); });
  Pose turned = pose_of(test.document());
  turned.rotation[kTrunk] = glm::angleAxis(0.3, glm::dvec3(1, 0, 0));
  commit_pose(*test.editor, "Turn", turned);
  const Pose held = pose_of(test.document());
  CHECK(std::abs(held.rotation[kTrunk].w) > 1 - 1e-12);
  go_to_frame(*test.editor, 30);
  commit_pose(*test.editor, "Same", held);  // the same pose as at frame 10
  test.editor->selection->bones = {kTrunk};
  run(*test.editor, "motion.insert_key");
  const glm::dquat keyed = shown_clip(test.editor->document())->keys.bones.at("Trunk").at(30);
  CHECK(std::abs(glm::dot(keyed, glm::angleAxis(1.0, glm::dvec3(0, 0, 1)))) > 1 - 1e-12);
}

TEST_CASE("constraint panel: a head is aimed by its face, and a project keeps and reopens what is constrained") {
  ArmEditor test;
  Document document = arm();
  Armature rig = *document.armature;
  rig.bones.push_back({"Head", kTrunk, {0, 0, 20}, {0, 4, 40}, 0.3});
  document.armature = std::make_shared<const Armature>(rig);
  document.frame = 7;
  test.editor->history->reset(document, "Head");
  test.editor->selection->bone = 5;
  test.editor->selection->bones = {5, kHand};
  run(*test.editor, "constraint.add_aim");
  REQUIRE(constraints_of(test.document()).list.size() == 1);
  const Pose aimed = pose_of(test.document());
  const glm::dvec3 face = glm::mat3_cast(aimed.rotation[5]) * glm::dvec3(0, -1, 0),
                   towards = glm::normalize(rig.bones[kHand].tail - rig.bones[5].head);
  CHECK(glm::dot(face, towards) > 0.9);  // the bone's axis deviates from the front by at most 20 degrees
  const TemporaryFolder folder;
  DocumentWriter writer;
  create_project({.document = test.document()}, folder / "head.limber", writer);
  const Document back = read_project(folder / "head.limber").document;
  CHECK(constraints_of(back) == constraints_of(test.document()));
  CHECK(*pose_at_frame(back) == aimed);
}

TEST_CASE("constraint panel: a planted hand stays while the trunk is turned by hand, with and without auto-key") {
  for (const bool auto_key : {false, true}) {
    ArmEditor test({planted_hand()});
    test.editor->timeline->auto_key = auto_key;
    Pose turned = pose_of(test.document());
    turned.rotation[kTrunk] = glm::angleAxis(-0.8, glm::dvec3(0, 0, 1));
    preview_pose(*test.editor, turned);  // as while a tool or a slider is dragged
    CHECK(glm::distance(tail_of(test.document(), shown_pose(*test.editor), kHand), tail_of(test.document(), kHand)) >
          5);
    const Pose dragged = shown_pose(*test.editor);
    commit_pose(*test.editor, "Turn", turned);
    CHECK(pose_of(test.document()) == dragged);
    CHECK(pose_of(test.document()).rotation[kTrunk] == turned.rotation[kTrunk]);
    CHECK(glm::distance(tail_of(test.document(), kHand), test.place()) < 0.01);
    CHECK(shown_clip(test.editor->document())->keys.bones.at("Trunk").contains(10) == auto_key);
    // Only the bones that the user turned get keys.
    CHECK(!shown_clip(test.editor->document())->keys.bones.contains("LeftForeArm"));
  }
}

TEST_CASE(
    "constraint panel: a pose made by hand is kept as keys when the first constraint is added, and after it goes") {
  ArmEditor test;
  Document bare = arm();
  Pose pose = rest_pose(*bare.armature);
  pose.rotation[kTrunk] = glm::angleAxis(0.4, glm::dvec3(0, 1, 0));
  bare.pose = std::make_shared<const Pose>(pose);
  test.editor->history->reset(bare, "Pose");
  run(*test.editor, "constraint.add_aim");
  REQUIRE(constraints_of(test.document()).list.size() == 1);
  CHECK(pose_of(test.document()).rotation[kTrunk] == pose.rotation[kTrunk]);
  run(*test.editor, "constraint.remove");
  CHECK(pose_of(test.document()) == pose);
  // Without a pose, no key is set. Removing the constraint also removes the pose that it made.
  test.editor->history->reset(arm(), "Rest");
  run(*test.editor, "constraint.add_aim");
  const std::string name = constraints_of(test.document()).list[0].name;
  change_constraint(*test.editor, name, "Move target", [](Constraint& aim) { aim.place = {0, -90, 0}; });
  CHECK(test.document().pose);
  CHECK(shown_clip(test.editor->document())->keys.empty());
  run(*test.editor, "constraint.remove");
  CHECK(!test.document().pose);
}

TEST_CASE("constraint panel: circles and targets that move along are refused with one line, and nothing changes") {
  ArmEditor test({planted_hand()}, kThigh, kHand);
  const Document before = test.document();
  run(*test.editor, "constraint.add_aim");
  CHECK(test.fact("error") == "These constraints depend on each other in a cycle");
  CHECK_THROWS_WITH(add_constraint(*test.editor, ConstraintKind::Aim),
                    "these constraints depend on each other in a cycle: Aim LeftThigh and Plant LeftHand: choose "
                    "another target, or remove one");
  CHECK(test.document() == before);
  test.play("key Escape\n wait-idle");
  CHECK_THROWS_WITH(set_target(*test.editor, "Plant LeftHand", "LeftForeArm"),
                    "the constrained bone moves its own target: Plant LeftHand: choose another target");
  test.editor->selection->bones = {kTrunk};
  test.editor->selection->bone = kTrunk;
  CHECK_THROWS_WITH(add_constraint(*test.editor, ConstraintKind::Plant),
                    "a plant needs two bones above the bone: Plant Trunk: choose a hand or foot");
  CHECK(test.document() == before);
}

TEST_CASE("constraint panel: the order is changed by the buttons, only past what turns the same bones, and undone") {
  std::vector<Constraint> list = two_aims();
  list.insert(list.begin() + 1, {.name = "Leg", .kind = ConstraintKind::Aim, .bone = "LeftThigh", .place{0, 90, 0}});
  ArmEditor test(list, kUpper);
  const auto names = [&] {
    std::string all;
    for (const Constraint& one : constraints_of(test.document()).list) all += one.name;
    return all;
  };
  const auto aims_at = [&](const glm::dvec3& place) {
    const Pose& pose = pose_of(test.document());
    const glm::dvec3 head = test.document().armature->bones[kUpper].head, tail = tail_of(test.document(), kUpper);
    const glm::dvec3 posed_head = tail_of(test.document(), pose, kTrunk);  // the arm starts at the trunk's tail
    CHECK(head == test.document().armature->bones[kTrunk].tail);
    return glm::dot(glm::normalize(tail - posed_head), glm::normalize(place - posed_head)) > 0.999;
  };
  test.editor->timeline->constraint = "A";
  test.play("wait-idle");
  CHECK(test.fact("widget:A/Up") != "shown");
  CHECK(aims_at({0, 0, -90}));
  test.play("click Constraints/A/Down\n wait-idle");
  CHECK(names() == "LegBA");
  CHECK(aims_at({90, 0, 0}));
  test.play("click Constraints/A/Up\n wait-idle");
  CHECK(names() == "LegAB");
  test.play("key Ctrl+Z\n wait-idle\n key Ctrl+Z\n wait-idle");
  CHECK(names() == "ALegB");
  CHECK(aims_at({0, 0, -90}));
}

TEST_CASE("constraint panel: a project reopens with the pose below the constraints that was made by hand") {
  const TemporaryFolder folder;
  DocumentWriter writer;
  Pose shown, free;
  std::string state;
  {
    ArmEditor test({planted_hand(0.5)});
    Pose turned = pose_of(test.document());
    turned.rotation[kUpper] = glm::angleAxis(0.7, glm::dvec3(0, 1, 0)) * turned.rotation[kUpper];
    commit_pose(*test.editor, "Turn", turned);
    shown = pose_of(test.document());
    free = unconstrained_pose(*test.editor);
    REQUIRE(free_pose_by_hand(*test.editor));
    create_project({.document = test.document()}, folder / "arm.limber", writer);
    state = editor_state(*test.editor);
  }
  ArmEditor other;
  // Restoring a state has no effect on a clip without constraints.
  restore_editor_state(*other.editor, state);
  CHECK_FALSE(free_pose_by_hand(*other.editor));
  other.editor->history->reset(read_project(folder / "arm.limber").document, "Open");
  REQUIRE(pose_of(other.document()) == shown);
  CHECK(unconstrained_pose(*other.editor) != free);  // a project does not store the pose without constraints
  restore_editor_state(*other.editor, state);
  CHECK(unconstrained_pose(*other.editor) == free);
}

TEST_CASE("constraint panel: no order is offered where one constraint must wait for the other whatever the order") {
  const Constraint aim{.name = "Look", .kind = ConstraintKind::Aim, .bone = "LeftForeArm", .place{90, 0, 0}};
  const Constraint leg{.name = "Leg", .kind = ConstraintKind::Aim, .bone = "LeftThigh", .place{0, 90, 0}};
  for (const bool plant_first : {true, false}) {
    CAPTURE(plant_first);
    const std::vector<Constraint> list =
        plant_first ? std::vector{planted_hand(), leg, aim} : std::vector{aim, leg, planted_hand()};
    ArmEditor test(list, kFore);
    // Both constraints turn the forearm, and the pose is the same in either order.
    const ConstraintStack* stack = test.editor->timeline->prepared->constraints();
    REQUIRE(stack);
    const std::vector<int>&a = stack->turned(0), &b = stack->turned(2);
    REQUIRE(std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end());
    for (const InOrder where : {InOrder::Earlier, InOrder::Later})
      for (const Constraint& one : list) CHECK_FALSE(order_neighbour(*test.editor, one.name, where));
    CHECK(disabled_reason(*test.editor, *find_operator(test.editor->operators, "constraint.up")) ==
          "The constraint cannot move up: its order among the constraints that turn its bones would stay the same");
  }
}

TEST_CASE("constraint panel: one that is switched off is moved past what it would rival once it is on") {
  std::vector<Constraint> list = two_aims();
  list[1].on = false;
  ArmEditor test(list, kUpper);
  const Constraint* earlier = order_neighbour(*test.editor, "B", InOrder::Earlier);
  REQUIRE(earlier);
  CHECK(earlier->name == "A");
  CHECK_FALSE(order_neighbour(*test.editor, "B", InOrder::Later));
  move_constraint(*test.editor, "B", InOrder::Earlier);
  CHECK(constraints_of(test.document()).list[0].name == "B");
}

}  // namespace limber::test
