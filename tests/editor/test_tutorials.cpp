// SPDX-License-Identifier: AGPL-3.0-or-later
// Plays the scripts of assets/tutorials unchanged.
#include <algorithm>

#include "core/base/file.h"
#include "core/phantom/phantom.h"
#include "core/rig/anatomical_position.h"
#include "core/rig/joint_limits.h"
#include "tests/editor/sitting.h"

using namespace limber;
using namespace limber::editor;
using namespace limber::test;

TEST_CASE("tutorials: an arm is rigged from nothing, weighted and bent in twelve actions") {
  const Home home;
  const Phantom arm = make_arm_phantom(5);
  write_volume(arm.volume, home / "arm.nrrd", arm.tissues);
  const auto script = parse_script(read_file(Path(LIMBER_SOURCE_DIR) / "assets/tutorials/rig_an_arm.txt"));
  CHECK(std::count_if(script.begin(), script.end(),
                      [](const ScriptLine& line) { return !line.words[0].starts_with("wait"); }) == 12);

  Sitting sitting(home.folder.path());
  sitting.editor().background->worker_program = LIMBER_PROGRAM;
  sitting.test.player.play(script, home.folder.path());

  const Document& document = sitting.editor().document();
  REQUIRE(document.armature);
  REQUIRE(document.weights);
  REQUIRE(document.pose);
  const Armature& rig = *document.armature;
  for (const char* joint : {"UpperArm", "Forearm", "Hand"}) {
    INFO(joint);
    REQUIRE(rig.find(joint));
    CHECK(glm::distance(rig.bones[*rig.find(joint)].head, arm.armature.bones[require_bone(arm.armature, joint)].head) <
          8);
  }
  const Bone& forearm = rig.bones[*rig.find("Forearm")];
  CHECK(forearm.limits.type == JointLimits::Type::Hinge);
  CHECK(glm::degrees(forearm.limits.maximum + hinge_angle_at_rest(rig, *rig.find("Forearm"), forearm.limits.axis)) ==
        doctest::Approx(150));
  CHECK(glm::degrees(2 * std::acos(std::abs(document.pose->rotation[*rig.find("Forearm")].w))) == doctest::Approx(60));
  CHECK(limit_excess(forearm, document.pose->rotation[*rig.find("Forearm")]) < 1e-9);
  CHECK(sitting.editor().history->steps().size() < 9);  // number of edits, each of which can be undone
}
