// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests the operators that place and fit skeletons.
#include <algorithm>

#include "core/motion/constraint.h"
#include "core/phantom/phantom.h"
#include "core/rig_io/rig_templates.h"
#include "editor/context/operator.h"
#include "editor/rig/auto_rig.h"
#include "editor/rig/joint_axis_fit.h"
#include "editor/volume/volume_edits.h"
#include "tests/editor/operator_proofs.h"

namespace limber::test {

using namespace editor;

namespace {

// Opens two bars of bone that meet end to end. The hinge lies in the middle of their section, so bending drives a
// corner of one bar into the other.
void open_bars(Stage& stage) {
  stage.open_limb();
  Document document = stage.document();
  auto volume = std::make_shared<LabelVolume>();
  volume->grid = {.size = {41, 41, 12}, .spacing = {2, 2, 2}, .origin = {-40, -40, -10}};
  volume->voxels.assign(volume->grid.voxel_count(), 0);
  for (int z = 2; z < 10; ++z)
    for (int y = 15; y < 26; ++y)
      for (int x = 2; x < 39; ++x)
        if (x != 20) volume->at({x, y, z}) = 111;
  Armature rig;
  rig.bones = {{"Fixed", -1, {-38, 0, 0}, {0, 0, 0}}, {"Turning", 0, {0, 0, 0}, {38, 0, 0}}};
  rig.bones[1].limits = {.type = JointLimits::Type::Hinge, .axis = {0, 0, 1}, .minimum = 0, .maximum = 1};
  document.volume = volume;
  document.armature = std::make_shared<const Armature>(rig);
  stage.editor().history->commit("Bars", document);
  *stage.editor().selection = {};
  stage.editor().selection->bone = 1;
  stage.editor().selection->bones = {1};
  stage.play("key Ctrl+1\n move \"3D view/view\"\n wait-idle");
}

}  // namespace

std::vector<Proof> proofs_of_rig_fitting() {
  const char* rigging = "key Ctrl+1\n move \"3D view/view\"\n wait-idle";
  return {
      {"rig.templates", "click rig.templates\n click Rig/list\n click \"Rig/Quadruped\"\n key Return",
       [](Stage& s, const Seen&) {
         return s.is("edit", "Add template Quadruped") &&
                s.document().armature->bones.size() == rig_template("quadruped").bones.size() &&
                check_rig(*s.document().volume, *s.document().armature).whole > 0.1;
       },
       Shows::InBody, rigging},
      // The names of this rig mean nothing, so the fit is quick.
      {"rig.auto_fit", "key Ctrl+Shift+F\n click Rig/list\n click \"Rig/The current rig\"\n key Return\n wait-job",
       [](Stage& s, const Seen& b) {
         return s.is("edit", "Auto-fit rig") && s.document().armature != b.document.armature &&
                s.is("toast", "Rig positioned, but every joint is uncertain");
       },
       Shows::Nothing, rigging},
      {"rig.fit_joint_axis", "key Shift+J\n wait-job\n wait-idle",
       [](Stage& s, const Seen& b) {
         const ProposedJoint* proposed = proposed_joint(s.editor());
         return proposed && proposed->fit.overlap_before > 50 && proposed->fit.overlap_after == 0 &&
                s.document().armature == b.document.armature &&
                s.is("text:" + grouped(proposed->fit.overlap_before) + " \u2192 0");
       },
       Shows::InBody, "", open_bars},
      {"rig.joint_fit_after", "click \"3D view/joint axis/rig.joint_fit_after\"",
       [](Stage& s, const Seen&) {
         return proposed_joint(s.editor())->shows_after &&
                s.editor().views->scene.armature == proposed_joint(s.editor())->fitted;
       },
       Shows::InBody},
      {"rig.joint_fit_before", "click \"3D view/joint axis/rig.joint_fit_before\"",
       [](Stage& s, const Seen&) {
         return !proposed_joint(s.editor())->shows_after && s.editor().views->scene.armature == s.document().armature;
       },
       Shows::InBody},
      {"rig.leave_joint_fit", "click \"3D view/joint axis/rig.leave_joint_fit\"",
       [](Stage& s, const Seen& b) {
         return !proposed_joint(s.editor()) && s.document().armature == b.document.armature;
       },
       Shows::InBody},
      {"rig.take_joint_fit", "click \"3D view/joint axis/rig.take_joint_fit\"",
       [](Stage& s, const Seen&) {
         const Bone& turning = s.document().armature->bones.back();
         return s.is("edit", "Fit joint axis of Turning") && !proposed_joint(s.editor()) &&
                std::abs(turning.head.y) > 4 && turning.limits.minimum == 0 && turning.limits.maximum == 1;
       },
       Shows::InBody, "key Shift+J\n wait-job\n wait-idle"},
  };
}

TEST_CASE("joint axis: a fit that moves the target bone of a constraint says so") {
  Stage stage;
  open_bars(stage);
  Document document = stage.document();
  Clip clip{.name = "sit", .range_end = 10};
  clip.constraints = std::make_shared<const Constraints>(Constraints{
      {{.name = "Aim", .kind = ConstraintKind::Aim, .bone = "Fixed", .target = "Turning", .place{0, 0, 9}}}});
  document.clips = {std::make_shared<const Clip>(clip)};
  stage.editor().history->commit("Aim", document);
  stage.play("wait-idle\n key Shift+J\n wait-job\n wait-idle\n click \"3D view/joint axis/rig.take_joint_fit\"");
  const auto& log = stage.editor().messages->log;
  CHECK(std::any_of(log.begin(), log.end(), [](const LogLine& line) {
    return line.severity == Severity::Warning &&
           line.text.find("Fit joint axis of Turning: targets of constraints moved") == 0;
  }));
}

TEST_CASE("joint axis: a joint without a hinge is fitted as the hinge it bends by, and says that it becomes one") {
  Stage stage;
  open_bars(stage);
  Document document = stage.document();
  Armature rig = *document.armature;
  rig.bones[1].limits = {};
  rig.bones[0].head = {-38, 14, 0};  // not in line, so that the joint has a bending direction
  document.armature = std::make_shared<const Armature>(rig);
  stage.editor().history->commit("Free", document);
  stage.play("wait-idle\n key Shift+J\n wait-job\n wait-idle");
  INFO(stage.fact("toast"), ", error ", stage.fact("error"));
  REQUIRE(proposed_joint(stage.editor()));
  CHECK(stage.document().armature->bones[1].limits.type == JointLimits::Type::Free);
  CHECK(proposed_joint(stage.editor())->fit.overlap_before > proposed_joint(stage.editor())->fit.overlap_after);
  stage.play("expect \"text:Becomes a hinge\"\n click \"3D view/joint axis/rig.take_joint_fit\"");
  CHECK(stage.document().armature->bones[1].limits.type == JointLimits::Type::Hinge);
}

TEST_CASE("operators: rigs are placed and fitted") {
  Stage stage;
  prove(stage, proofs_of_rig_fitting());
}

TEST_CASE("rig fitting: what collides is shown until the axis is moved, and not of a rig that was changed meanwhile") {
  Stage stage;
  open_bars(stage);
  stage.play("key Shift+J\n wait-job\n wait-idle");
  const ProposedJoint* proposed = proposed_joint(stage.editor());
  REQUIRE(proposed);
  const render::Scene& scene = stage.editor().views->scene;
  CHECK(scene.display == render::Display::XRay);
  REQUIRE(scene.weights);
  // The colliding voxels, and no others, are pink. With the fitted axis, none are.
  const auto pink = [&] {
    return std::count(scene.weights->field->begin(), scene.weights->field->end(), glm::u8vec3(0xFF, 0x3E, 0xA5));
  };
  CHECK(pink() == std::ssize(proposed->fit.colliding_before));
  CHECK(pink() > 100);
  run(stage.editor(), "rig.joint_fit_after");
  stage.play("wait-idle");
  CHECK(pink() == 0);
  // Other workspaces show the body as usual. When the Rig workspace is shown again, it still shows the proposal.
  stage.play("key Ctrl+4\n wait-idle");
  CHECK_FALSE(scene.weights);
  stage.play("key Ctrl+1\n wait-idle");
  CHECK(scene.weights);
  Document other = stage.document();
  Armature rig = *other.armature;
  rig.bones[1].tail.x += 1;
  other.armature = std::make_shared<const Armature>(rig);
  commit(stage.editor(), "Longer", other);
  stage.play("wait-idle");
  CHECK_FALSE(scene.weights);
  CHECK_FALSE(disabled_reason(stage.editor(), *find_operator(stage.editor().operators, "rig.take_joint_fit")).empty());
}

TEST_CASE(
    "rig fitting: a fitted rig is one edit, takes the old weights and pose away, and tells the least sure "
    "joints") {
  Stage stage;
  Document document = stage.document();
  const Phantom arm = make_arm_phantom(6);
  document.volume = std::make_shared<const LabelVolume>(arm.volume);
  document.tissues = std::make_shared<const TissueTable>(arm.tissues);
  document.armature.reset();
  document.weights.reset();
  document.pose.reset();
  stage.editor().history->commit("Arm", document);
  start_auto_fit(stage.editor(), "arm");
  stage.play("wait-job");
  REQUIRE(stage.document().armature);
  CHECK(stage.is("edit", "Auto-fit rig"));
  const auto& log = stage.editor().messages->log;
  CHECK(std::count_if(log.begin(), log.end(), [](const LogLine& line) {
          return line.text.find("found by bone surface") != std::string::npos;
        }) == 22);
  const auto elbow = stage.document().armature->find("Forearm");
  REQUIRE(elbow);
  CHECK(glm::distance(stage.document().armature->bones[*elbow].head,
                      arm.armature.bones[require_bone(arm.armature, "Forearm")].head) < 8);
  stage.play("key Ctrl+Z");
  CHECK(!stage.document().armature);
}

}  // namespace limber::test
