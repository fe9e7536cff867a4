// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <tuple>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

using namespace limber::test;

namespace {

struct BakedArm {
  TemporaryFolder folder;
  std::string volume = folder / "volume.nrrd", rig = folder / "rig.json", tissues = folder / "tissues.json",
              weights = folder / "w.nrrd", baked = folder / "elbow.bake", posed = folder / "posed.nrrd";

  BakedArm() {
    REQUIRE(run_limber({"phantom", "arm", "--spacing", "8", "-o", folder.path()}).exit_code == 0);
    REQUIRE(run_limber({"weights", volume, "--rig", rig, "--tissues", tissues, "-o", weights}).exit_code == 0);
    const auto run =
        run_limber({"bake-joint", volume, "--rig", rig, "--tissues", tissues, "--weights", weights, "--bone", "Forearm",
                    "--range", "0,50", "--angles", "2", "--quality", "draft", "--no-contact", "-o", baked});
    REQUIRE(run.exit_code == 0);
    CHECK(run.out.find("Forearm is baked from +0 to +50 degrees") != std::string::npos);
  }
  ProgramRun resample(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"resample",  volume,  "--rig",   rig,   "--tissues", tissues,
                                      "--weights", weights, "--baked", baked, "-o",        posed};
    words.insert(words.end(), more.begin(), more.end());
    return run_limber(words);
  }
};

const BakedArm& arm() {
  static const BakedArm arm;
  return arm;
}

}  // namespace

TEST_CASE("bake-joint command: the report of a pose names the baked joint, its angle and its error") {
  const std::string report = arm().folder / "report.json";
  REQUIRE(arm().resample({"--method", "dqs", "--flex", "Forearm=40", "--report", report}).exit_code == 0);
  std::ifstream in(report);
  const auto json = nlohmann::json::parse(in);
  REQUIRE(json["baked_joints"].size() == 1);
  const auto& joint = json["baked_joints"][0];
  CHECK(joint["bone"] == "Forearm");
  CHECK(joint["degrees"].get<double>() == doctest::Approx(40));
  CHECK(joint["baked_at_degrees"].size() == 3);
  CHECK(joint["beyond_baked_range"] == false);
  CHECK(joint["error_between"]["skin_95_mm"].get<double>() > 0);
  bool is_input = false;
  for (const auto& input : json["inputs"]) is_input |= input["path"] == arm().baked;
  CHECK(is_input);
}

TEST_CASE("bake-joint command: info tells what a baked joint is and how far it is from finite elements") {
  const auto run = run_limber({"info", arm().baked, "--json"});
  REQUIRE(run.exit_code == 0);
  const auto json = nlohmann::json::parse(run.out);
  CHECK(json["kind"] == "baked joint");
  CHECK(json["bone"] == "Forearm");
  CHECK(json["baked_at_degrees"] == nlohmann::json({0, 25, 50}));
  CHECK(json["errors_between"].size() == 2);
  CHECK(json["contact"] == false);
}

TEST_CASE("bake-joint command: a pose that the stated error does not hold for is warned of") {
  for (const auto& [more, says] :
       {std::pair<std::vector<std::string>, const char*>{{"--flex", "Forearm=70"}, "baked from +0 to +50 only"},
        {{"--flex", "Forearm=30", "--glide", "off"}, "was baked with \"joint\""}}) {
    std::vector<std::string> words = {"--method", "dqs"};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = arm().resample(words);
    CAPTURE(run.err);
    CHECK(run.exit_code == 0);
    CHECK(run.err.find(says) != std::string::npos);
  }
}

TEST_CASE("bake-joint command: what does not fit is one clear line, and no file is left") {
  const BakedArm& body = arm();
  std::filesystem::remove(body.posed);
  const std::string other_weights = body.folder / "other.nrrd", damaged = body.folder / "damaged.bake";
  REQUIRE(run_limber({"weights", body.volume, "--rig", body.rig, "--tissues", body.tissues, "--method", "rigid", "-o",
                      other_weights})
              .exit_code == 0);
  std::ofstream(damaged) << "limber baked joint 1\nno more";
  const auto words = [&](const std::string& weights, const std::string& baked) {
    return std::vector<std::string>{"resample", body.volume, "--rig", body.rig, "--tissues",  body.tissues, "--weights",
                                    weights,    "--baked",   baked,   "--flex", "Forearm=40", "-o",         body.posed};
  };
  auto foreign = words(other_weights, body.baked), broken = words(body.weights, damaged);
  for (auto* each : {&foreign, &broken}) each->insert(each->end(), {"--method", "dqs"});
  for (const auto& [line, says] : {std::pair{foreign, "baked from other weights"},
                                   {broken, "damaged.bake"},
                                   {words(body.weights, body.baked), "use --method dqs"}}) {
    const auto run = run_limber(line);
    CAPTURE(run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.err.find(says) != std::string::npos);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK_FALSE(std::filesystem::exists(body.posed));
  }
  for (const auto& [bone, range, says] : {std::tuple{"UpperArm", "0,90", "choose a bone that has a parent"},
                                          {"Forearm", "20,90", "such as -20,100"},
                                          {"Elbow", "0,90", "Elbow"}}) {
    const auto run = run_limber({"bake-joint", body.volume, "--rig", body.rig, "--weights", body.weights, "--bone",
                                 bone, "--range", range, "-o", body.folder / "none.bake"});
    CAPTURE(run.err);
    CHECK(run.exit_code == 1);
    CHECK(run.err.find(says) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(body.folder / "none.bake"));
  }
}
