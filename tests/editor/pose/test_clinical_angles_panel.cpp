// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>

#include "core/pose/joint_turns.h"
#include "editor/context/document_edits.h"
#include "editor/context/operator.h"
#include "editor/context/pose_editing.h"
#include "editor/context/transform_settings.h"
#include "editor/pose/clinical_angle_edits.h"
#include "editor/pose/pose_edits.h"
#include "editor/ui/ui.h"
#include "tests/editor/operator_proofs.h"
#include "tests/support/body_rig.h"

namespace limber::test {

using namespace editor;

namespace {

using enum BodyJoint;

// The editor in the Pose workspace with the rig of a whole body. Only the panel of clinical angles is open.
class AnglesStage : public Stage {
 public:
  explicit AnglesStage(const Armature& rig = body_rig()) {
    Document next = document();
    next.armature = std::make_shared<const Armature>(rig);
    next.weights.reset();
    next.pose.reset();
    commit(editor(), "Import rig", std::move(next));
    editor().ui->open_sections["Bone"] = false;
    editor().ui->open_sections["Pose library"] = false;
    play("resize 1280 1000\n key Ctrl+3\n wait-idle");
  }
  void choose(const std::string& bone) {
    *editor().selection = {};
    editor().selection->bone = require_bone(*document().armature, bone);
    editor().selection->bones = {*editor().selection->bone};
    play("wait-idle");
  }
  void type(const std::string& field, const std::string& number) {
    play("double-click \"Clinical angles/" + field + "\"\nkey Ctrl+A\ntype \"" + number + "\"\nkey Return\nwait-idle");
  }
  double angle(const SidedJoint& joint, std::size_t motion) {
    return *angles_of_joint(*document().armature, body_frames(*document().armature), pose_of(document()),
                            joint)[motion];
  }
  int edits() { return static_cast<int>(editor().history->position()); }
};

}  // namespace

TEST_CASE("clinical angles panel: a typed angle is one edit of one motion, stops at its range and is undone") {
  AnglesStage s;
  s.choose("LeftThigh");
  const int before = s.edits();
  s.type("Left hip flexion", "60");
  CHECK(s.angle({Hip, BodySide::Left}, 0) == doctest::Approx(60));
  CHECK(s.edits() == before + 1);
  s.type("Left hip abduction", "20");
  CHECK(s.angle({Hip, BodySide::Left}, 0) == doctest::Approx(60));
  CHECK(s.angle({Hip, BodySide::Left}, 1) == doctest::Approx(20));
  CHECK(std::abs(s.angle({Hip, BodySide::Right}, 0)) < 1e-9);
  s.type("Left hip flexion", "200");
  CHECK(s.angle({Hip, BodySide::Left}, 0) == doctest::Approx(125));
  s.play("key Ctrl+Z\n wait-idle");
  CHECK(s.angle({Hip, BodySide::Left}, 0) == doctest::Approx(60));
  s.play("key Ctrl+Z\n key Ctrl+Z\n wait-idle");
  CHECK(pose_of(s.document()) == rest_pose(*s.document().armature));
  s.play("key Ctrl+Shift+Z\n wait-idle");
  CHECK(s.angle({Hip, BodySide::Left}, 0) == doctest::Approx(60));
  s.editor().posing->keep_limits = false;
  s.type("Left hip flexion", "140");
  CHECK(s.angle({Hip, BodySide::Left}, 0) == doctest::Approx(140));
}

TEST_CASE("clinical angles panel: a slider's drag shows the pose, is one edit at its end, and Escape drops it") {
  AnglesStage s;
  s.choose("RightShank");
  const int before = s.edits();
  s.play("drag \"Clinical angles/Slide Right knee flexion\" 20 0\n wait-idle");
  const double bent = s.angle({Knee, BodySide::Right}, 0);
  CHECK(bent > 70);  // beyond the middle of the range
  CHECK(bent < 150);
  CHECK(s.edits() == before + 1);
  s.play("press \"Clinical angles/Slide Right knee flexion\"\n move \"3D view/view\"\n wait 0.1");
  CHECK(s.editor().views->preview_pose);
  s.play("key Escape\n release\n wait-idle");
  CHECK_FALSE(s.editor().views->preview_pose);
  CHECK(s.edits() == before + 1);
  CHECK(s.angle({Knee, BodySide::Right}, 0) == bent);
}

TEST_CASE("clinical angles panel: X-mirror sets both sides, and auto-key keeps the angle as a key") {
  AnglesStage s;
  s.choose("LeftUpperArm");
  run(s.editor(), "edit.x_mirror");
  s.type("Left shoulder abduction", "50");
  CHECK(s.angle({Shoulder, BodySide::Left}, 1) == doctest::Approx(50));
  CHECK(s.angle({Shoulder, BodySide::Right}, 1) == doctest::Approx(50));
  // The collarbone moves with the arm.
  CHECK(s.angle({Girdle, BodySide::Right}, 2) == doctest::Approx(20.0 / 6));
  s.type("Left shoulder abduction", "90");
  s.play("expect \"text:At 90\u00b0 of abduction, the joint's other motions turn about the same axis.\"");
}

TEST_CASE("clinical angles panel: a list selects any joint, a forearm has two, and a hand curls and spreads") {
  AnglesStage s;
  *s.editor().selection = {};
  s.play("wait-idle\n click \"Clinical angles/Joint/list\"\n wait-idle\n click \"Right elbow\"\n wait-idle");
  CHECK(s.editor().selection->bone == require_bone(*s.document().armature, "RightForearm"));
  s.type("Right elbow flexion", "70");
  s.type("Right forearm pronation", "80");
  CHECK(s.angle({Elbow, BodySide::Right}, 0) == doctest::Approx(70));
  CHECK(s.angle({Forearm, BodySide::Right}, 0) == doctest::Approx(80));
  s.choose("RightHand");
  s.type("Right hand curl", "60");
  CHECK(s.angle({Ring, BodySide::Right}, 0) == doctest::Approx(60));
  CHECK(s.angle({Ring, BodySide::Right}, 2) == doctest::Approx(40));
  CHECK(s.angle({Thumb, BodySide::Right}, 1) == doctest::Approx(30));
  s.type("Right hand spread", "12");
  CHECK(s.angle({Index, BodySide::Right}, kSpread) == doctest::Approx(12));
  CHECK(s.angle({Ring, BodySide::Right}, 0) == doctest::Approx(60));
  CHECK(s.angle({Forearm, BodySide::Right}, 0) == doctest::Approx(80));
}

TEST_CASE("clinical angles panel: pronation stops where the hand's own limits do, and a bent wrist leaves it") {
  Armature rig = body_rig();
  rig.bones[require_bone(rig, "RightHand")].limits = {
      .type = JointLimits::Type::Ball, .cone = 1.4, .twist_minimum = -0.1, .twist_maximum = 0.1};
  AnglesStage s(rig);
  s.choose("RightForearm");
  const double before = s.angle({Forearm, BodySide::Right}, 0);
  s.type("Right forearm pronation", "85");
  const double pronated = s.angle({Forearm, BodySide::Right}, 0);
  CHECK(pronated > before + 2);
  CHECK(pronated < 80);  // the hand takes a part of the pronation, and its limits cut that part
  s.choose("RightHand");
  s.type("Right wrist flexion", "30");
  CHECK(s.angle({Forearm, BodySide::Right}, 0) == doctest::Approx(pronated).epsilon(0.02));
  CHECK(s.angle({Wrist, BodySide::Right}, 0) == doctest::Approx(30).epsilon(0.02));
}

TEST_CASE("clinical angles panel: fingers spread though the rig's knuckles are hinges, and hinges keep their range") {
  Armature rig = body_rig();
  for (Bone& bone : rig.bones)
    if (bone.name.find("HandIndex1") != std::string::npos)
      bone.limits = {.type = JointLimits::Type::Hinge,
                     .axis = glm::dvec3(bone.name[0] == 'L' ? -1 : 1, 0, 0),
                     .minimum = -0.2,
                     .maximum = 1.2};
  AnglesStage s(rig);
  s.choose("LeftHandIndex1");
  s.type("Left index spread", "15");
  CHECK(s.angle({Index, BodySide::Left}, kSpread) == doctest::Approx(15));
  s.type("Left index knuckle flexion", "100");
  CHECK(s.angle({Index, BodySide::Left}, 0) ==
        doctest::Approx(range_of_motion(rig, body_frames(rig), {Index, BodySide::Left}, 0).high));
  CHECK(s.angle({Index, BodySide::Left}, kSpread) == doctest::Approx(15));
}

}  // namespace limber::test
