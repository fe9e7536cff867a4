// SPDX-License-Identifier: AGPL-3.0-or-later
// Skeletons are laid into the volume.
#include <algorithm>

#include "core/rig/templates.h"
#include "core/volume/phantom.h"
#include "editor/rig_fitting.h"
#include "tests/editor/operator_proofs.h"

namespace limber::test {

using namespace editor;

std::vector<Proof> proofs_of_rig_fitting() {
  const char* rigging = "key Ctrl+1\n move \"3D view/view\"\n wait-idle";
  return {
      {"rig.templates", "click rig.templates\n click Skeleton/list\n click \"Skeleton/Quadruped\"\n key Return",
       [](Stage& s, const Seen&) { return s.is("edit", "Template Quadruped") && s.document().armature->bones.size() == rig_template("quadruped").bones.size() && check_rig(*s.document().volume, *s.document().armature).whole > 0.1; },
       Shows::InBody, rigging},
      // A rig of names that mean nothing, so that it is over soon.
      {"rig.auto_fit", "key Ctrl+Shift+F\n click Skeleton/list\n click \"Skeleton/The rig that is here\"\n key Return\n wait-job",
       [](Stage& s, const Seen& b) { return s.is("edit", "Auto-fit skeleton") && s.document().armature != b.document.armature && s.is("toast", "Skeleton fitted"); }, Shows::Nothing, rigging},
  };
}

TEST_CASE("operators: skeletons are placed and fitted") {
  Stage stage;
  prove(stage, proofs_of_rig_fitting());
}

TEST_CASE("rig fitting: a fitted skeleton is one edit, takes the old weights and pose away, and tells the least sure joints") {
  Stage stage;
  Document document = stage.document();
  const Phantom arm = make_arm_phantom(6);
  document.volume = std::make_shared<const LabelVolume>(arm.volume);
  document.tissues = std::make_shared<const TissueTable>(arm.tissues);
  document.armature.reset();
  document.weights.reset();
  document.pose.reset();
  stage.editor().history.commit("Arm", document);
  start_auto_fit(stage.editor(), "arm");
  stage.play("wait-job");
  REQUIRE(stage.document().armature);
  CHECK(stage.is("edit", "Auto-fit skeleton"));
  const auto& log = stage.editor().messages.log;
  CHECK(std::count_if(log.begin(), log.end(), [](const LogLine& line) { return line.text.find("found by bone surface") != std::string::npos; }) == 22);
  const auto elbow = stage.document().armature->find("Forearm");
  REQUIRE(elbow);
  CHECK(glm::distance(stage.document().armature->bones[*elbow].head, arm.armature.bones[require_bone(arm.armature, "Forearm")].head) < 8);
  stage.play("key Ctrl+Z");
  CHECK(!stage.document().armature);
}

}  // namespace limber::test
