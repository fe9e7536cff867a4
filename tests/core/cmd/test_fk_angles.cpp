// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <fstream>
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/pose/pose_io.h"
#include "core/rig_io/rig_io.h"
#include "tests/support/body_rig.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

using Json = nlohmann::json;

TEST_CASE("fk: --angles prints what was asked of joints, and its JSON is a file of the same pose for any rig") {
  const TemporaryFolder folder;
  const std::string rig = (folder / "rig.json").string(), other = (folder / "other.json").string();
  write_armature(body_rig(), rig);
  write_armature(rested(body_rig(kMixamoNames), {{"mixamorig:LeftArm", {0, 1, 0}, -90}}), other);
  const ProgramRun run = run_limber({"fk", rig, "--pose-name", "squat", "--joint", "left wrist extension=30", "--joint",
                                     "hands spread=12", "--angles", "--json"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Json angles = Json::parse(run.out)["angles"];
  const auto near = [&](const char* joint, const char* motion, double degrees) {
    CHECK_MESSAGE(std::abs(angles[joint][motion].get<double>() - degrees) < 1e-6, joint, motion);
  };
  near("right hip", "flexion", 110);
  near("left hip", "abduction", 15);
  near("left knee", "flexion", 120);
  near("right ankle", "dorsiflexion", 25);
  near("left shoulder", "flexion", 80);
  near("left forearm", "pronation", 90);
  near("left wrist", "flexion", -30);
  near("left index", "spread", 12);

  std::ofstream(folder / "angles.json") << run.out;
  const ProgramRun again = run_limber({"fk", other, "--pose", (folder / "angles.json").string(), "--angles", "--json"});
  INFO(again.err);
  REQUIRE(again.exit_code == 0);
  const Json read = Json::parse(again.out)["angles"];
  for (const auto& [joint, motions] : angles.items())
    for (const auto& [motion, degrees] : motions.items())
      CHECK_MESSAGE(std::abs(read[joint][motion].get<double>() - degrees.get<double>()) < 1e-6, joint, " ", motion);
}

TEST_CASE("fk: --angles lists ranges and tells of angles beyond them, and refuses a rig whose bones it does not know") {
  const TemporaryFolder folder;
  const std::string rig = (folder / "rig.json").string(), nameless = (folder / "nameless.json").string();
  write_armature(body_rig(), rig);
  write_armature({{{.name = "Bone", .tail = {0, 0, 10}}}}, nameless);
  const ProgramRun run =
      run_limber({"fk", rig, "--joint", "left hip flexion=140", "--joint", "left shoulder abduction=90", "--angles"});
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("140.0   -30 to 125, beyond") != std::string::npos);
  CHECK(run.out.find("its other motions turn about the same axis") != std::string::npos);
  CHECK(run.out.find("-0.0") == std::string::npos);
  const ProgramRun refused = run_limber({"fk", nameless, "--angles"});
  CHECK(refused.exit_code == 1);
  CHECK(refused.err.find("no bone name of the rig is recognised") != std::string::npos);
}
