// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <fstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "tests/support/program.h"

using namespace limber;
using namespace limber::test;

namespace {

// The phantom arm. If the elbow of its rig lies 10 mm too far back, bending drives the forearm into the upper arm.
struct Arm {
  TemporaryFolder folder;
  std::string out = folder / "out.nrrd", report = folder / "report.json";

  explicit Arm(double too_far_back = 10) {
    REQUIRE(run_limber({"phantom", "arm", "--spacing", "3", "-o", folder.path()}).exit_code == 0);
    auto rig = nlohmann::json::parse(read_file(folder / "rig.json"));
    for (auto& bone : rig["bones"]) {
      if (bone["name"] == "Forearm") bone["head"][1] = bone["head"][1].get<double>() + too_far_back;
      if (bone["name"] == "UpperArm") bone["tail"][1] = bone["tail"][1].get<double>() + too_far_back;
    }
    std::ofstream(folder / "rig.json") << rig;
  }

  ProgramRun run(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"resample",  folder / "volume.nrrd",
                                   "--rig",     folder / "rig.json",
                                   "--tissues", folder / "tissues.json",
                                   "-o",        out,
                                   "--report",  report};
    words.insert(words.end(), more.begin(), more.end());
    return run_limber(words);
  }
  nlohmann::json posed(const std::vector<std::string>& more) const {
    const ProgramRun done = run(more);
    INFO(done.err);
    REQUIRE(done.exit_code == 0);
    return nlohmann::json::parse(read_file(report));
  }
};

}  // namespace

TEST_CASE(
    "glide: bones that would enter each other come apart where nothing is said, and the report says which joints "
    "glide" *
    doctest::test_suite("slow")) {
  const Arm arm;
  const auto stays = arm.posed({"--flex", "Forearm=100", "--glide", "off"}),
             glides = arm.posed({"--flex", "Forearm=100"});
  CHECK_FALSE(stays.contains("glide"));
  CHECK(stays["settings"]["glide"] == "off");
  CHECK(glides["settings"]["glide"] == "joint");
  REQUIRE(glides["glide"].size() == 1);
  const auto& joint = glides["glide"][0];
  CHECK(joint["bone"] == "Forearm");
  CHECK(joint["length_mm"].get<double>() > 0);
  CHECK(joint["length_mm"].get<double>() <= joint["most_mm"].get<double>() + 1e-9);
  CHECK(joint["depth_after_mm"].get<double>() < joint["depth_before_mm"].get<double>());
  CHECK(glides["total"]["bone_overlap_voxels"].get<int>() * 2 < stays["total"]["bone_overlap_voxels"].get<int>());
  for (const auto& limb : glides["limbs"]) CHECK(limb["orientation_off_degrees"].get<double>() < 0.1);
  for (const auto& bone : glides["bones"]) CHECK(bone["rigid_residual_mm"].get<double>() < 0.01);
}

TEST_CASE("glide: where no bones meet, the result is the same to the byte with and without" *
          doctest::test_suite("slow")) {
  const Arm arm(0);
  for (const char* method : {"mix", "lbs", "dqs"}) {
    const auto glides = arm.posed({"--flex", "Forearm=60", "--method", method});
    CHECK(glides["glide"].empty());
    const std::string bytes = read_file(arm.out);
    arm.posed({"--flex", "Forearm=60", "--method", method, "--glide", "off"});
    CHECK(read_file(arm.out) == bytes);
  }
}

TEST_CASE("glide: a pose file lets no bone go further than a voxel, and says what overlaps still" *
          doctest::test_suite("slow")) {
  const Arm arm;
  std::ofstream(arm.folder / "pose.json") << R"({"bones": {"Forearm": {"axis": [1, 0, 0], "degrees": -100}}})";
  const auto by_file = arm.posed({"--pose", arm.folder / "pose.json"});
  const std::string bytes = read_file(arm.out);
  CHECK(by_file["settings"]["glide"] == "voxel");
  for (const auto& joint : by_file["glide"]) CHECK(joint["length_mm"].get<double>() <= 3);
  arm.posed({"--pose", arm.folder / "pose.json", "--glide", "voxel"});
  CHECK(read_file(arm.out) == bytes);

  const ProgramRun run = arm.run({"--flex", "Forearm=100", "--glide", "0.5"});
  CHECK(run.exit_code == 0);
  CHECK_MESSAGE(run.err.find("Forearm still overlaps") != std::string::npos, run.err);
  CHECK(run.err.find("the command limber fit-joint") != std::string::npos);
  CHECK(run.err.find("--fit-joints") == std::string::npos);
}

TEST_CASE("glide: jobs say it as the command line does, and what is no way to glide is refused" *
          doctest::test_suite("slow")) {
  const Arm arm;
  arm.posed({"--flex", "Forearm=100", "--glide", "off"});
  const std::string stays = read_file(arm.out);
  std::ofstream(arm.folder / "job.json")
      << R"({"command": "resample", "volume": "volume.nrrd", "rig": "rig.json", "tissues": "tissues.json",
    "flex": ["Forearm=100"], "glide": "off", "output": "job.nrrd"})";
  REQUIRE(run_limber({"job", arm.folder / "job.json"}).exit_code == 0);
  CHECK(read_file(arm.folder / "job.nrrd") == stays);

  std::filesystem::remove(arm.out);
  for (const char* wrong : {"on", "0", "-3", "51", "2mm", "nan", "inf"}) {
    const ProgramRun run = arm.run({"--flex", "Forearm=100", std::string("--glide=") + wrong});
    INFO(wrong, " -> ", run.err);
    const bool is_number =
        // "nan" and "inf" are refused by the option parser itself, with exit code 2.
        std::string_view("nan inf").find(wrong) == std::string_view::npos;
    CHECK(run.exit_code == (is_number ? 1 : 2));
    CHECK(run.err.find(is_number ? "this is not a value of --glide" : "not a finite number") != std::string::npos);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK_FALSE(std::filesystem::exists(arm.out));
  }
}

TEST_CASE("glide: the results are the same bytes for any number of threads" * doctest::test_suite("slow")) {
  const Arm arm;
  std::vector<std::string> bytes;
  for (const char* threads : {"1", "2", "4"}) {
    arm.posed({"--flex", "Forearm=100", "--threads", threads});
    bytes.push_back(read_file(arm.out));
  }
  CHECK(bytes[0] == bytes[1]);
  CHECK(bytes[0] == bytes[2]);
}
