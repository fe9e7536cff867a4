// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests that the command line exports, from a project with strips, the motion that the editor plays.
#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/motion/motion_edit.h"
#include "core/motion/strip_edits.h"
#include "core/pose/pose_io.h"
#include "core/project/document_codec.h"
#include "core/project/project_io.h"
#include "tests/support/program.h"
#include "tests/support/sliding_walker.h"

namespace limber::test {

TEST_CASE("project: strips are listed, and exported as they play") {
  const TemporaryFolder folder;
  const auto rig = std::make_shared<const Armature>(walker());
  const auto motion = [&](double angle) {
    return std::make_shared<const Motion>(motion_of_poses(*rig, 31, 30, [&](int frame) {
      Pose pose = rest_pose(*rig);
      for (glm::dquat& rotation : pose.rotation) rotation = glm::angleAxis(angle * frame, glm::dvec3(1, 0, 0));
      return pose;
    }));
  };
  Document document;
  document.armature = rig;
  document.clips = {std::make_shared<const Clip>(clip_of(motion(0.01), "walk")),
                    std::make_shared<const Clip>(clip_of(motion(-0.02), "run"))};
  Strips strips;
  strips.tracks.push_back({.name = "Track 1", .strips = {strip_of(document.clips[0], strips, 0)}});
  insert_strip(strips.tracks[0], strip_of(document.clips[1], strips, 20));
  Clip clip{.name = "Strips", .range_end = 50};
  clip.strips = std::make_shared<const Strips>(strips);
  document.clips.push_back(std::make_shared<const Clip>(clip));
  document.clip = 2;
  const std::string project = folder / "strips.limber";
  DocumentWriter writer;
  create_project({.document = document}, project, writer);

  const ProgramRun inspected = run_limber({"project", project, "--json"});
  REQUIRE_MESSAGE(inspected.exit_code == 0, inspected.err);
  const auto listed = nlohmann::json::parse(inspected.out)["clips"][2]["strips"];
  CHECK(listed.size() == 2);
  CHECK(listed[1]["clip"] == "run");

  const ClipOnRig on_rig(document.clips[2], rig);
  const std::string pose_file = folder / "pose.json", take = folder / "take.bvh";
  const ProgramRun posed = run_limber({"project", project, "export", "pose", "--frame", "25", "-o", pose_file});
  REQUIRE_MESSAGE(posed.exit_code == 0, posed.err);
  const Pose pose = read_pose(pose_file, *rig), expected = on_rig.at(25);
  for (std::size_t bone = 0; bone < pose.rotation.size(); ++bone)
    CHECK(std::abs(glm::dot(pose.rotation[bone], expected.rotation[bone])) == doctest::Approx(1).epsilon(1e-9));
  const ProgramRun moved = run_limber({"project", project, "export", "motion", "-o", take});
  REQUIRE_MESSAGE(moved.exit_code == 0, moved.err);
  CHECK(read_bvh(take).frame_count == 51);
}

}  // namespace limber::test
