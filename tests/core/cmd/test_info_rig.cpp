// SPDX-License-Identifier: AGPL-3.0-or-later
#include <fstream>
#include <sstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {
bool is_motion_file(const std::string& path) {
  for (const char* extension : {".bvh", ".vtk", ".arm", ".gltf", ".glb", ".obj"})
    if (path.ends_with(extension)) return true;
  return false;
}

size_t lines_of(const std::string& text) { return static_cast<size_t>(std::count(text.begin(), text.end(), '\n')); }
}  // namespace

TEST_CASE("info: each rig, motion and model is taken, warned of or refused as it must be" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/EXPECT.tsv");
  std::ifstream in(test::shared_path("data/EXPECT.tsv"));
  int rows = 0;
  for (std::string row; std::getline(in, row);) {
    std::istringstream columns(row);
    std::string file, expected;
    std::getline(columns, file, '\t');
    std::getline(columns, expected, '\t');
    if (row.starts_with('#') || !is_motion_file(file)) continue;
    ++rows;
    const auto run = test::run_limber({"info", "--json", test::shared_path("data/" + file).string()});
    const std::string got = run.exit_code == 1   ? "refuse"
                            : run.exit_code != 0 ? "crash"
                            : run.err.empty()    ? "ok"
                                                 : "warn";
    CAPTURE(file);
    CAPTURE(run.err);
    CHECK_MESSAGE(("|" + expected + "|").find("|" + got + "|") != std::string::npos, got, " instead of ", expected);
    CHECK(lines_of(run.err) == (got == "ok" ? 0 : 1));
    if (got == "refuse") CHECK(run.out.empty());
    CHECK(run.cpu_seconds < 5);
  }
  CHECK(rows >= 16);
}

TEST_CASE("info: rigs and motions tell their bones, joints and frames") {
  struct Expected {
    const char *file, *kind;
    size_t count;
    int frames;
  };
  for (const Expected& e : {Expected{"bvh/cmu_01_01.bvh", "motion", 31, 2752},
                            {"bvh/rokoko_jesse_dance.bvh", "motion", 60, 1007},
                            {"bvh/mh_tpose_6ch.bvh", "motion", 173, 1},
                            {"bender/man-arm-2mm-armature.vtk", "rig", 21, 0},
                            {"bender/HumanArmature.arm", "rig", 29, 0},
                            {"bp3d/body.armature.json", "rig", 60, 0},
                            {"gltf/cesium_man.gltf", "rig", 19, 0}}) {
    NEEDS_SHARED(std::string("data/") + e.file);
    const auto run = test::run_limber({"info", "--json", test::shared_path(std::string("data/") + e.file).string()});
    REQUIRE(run.exit_code == 0);
    const auto json = nlohmann::json::parse(run.out);
    CHECK(json["kind"] == e.kind);
    CHECK(json[e.frames ? "joints" : "bones"].size() == e.count);
    if (e.frames) CHECK(json["frames"] == e.frames);
  }
}

TEST_CASE("fk: a rig at rest shows its heads and no rotation, a motion its own axes" * doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body.armature.json");
  const std::string rig = test::shared_path("data/bp3d/body.armature.json").string(),
                    bvh = test::shared_path("data/bvh/cmu_01_01.bvh").string();
  const auto rest = nlohmann::json::parse(test::run_limber({"fk", rig, "--json"}).out);
  CHECK(rest["joints"].size() == 60);
  CHECK(rest["joints"][1]["name"] == "Lumbar");
  CHECK(rest["joints"][1]["parent"] == "Pelvis");
  CHECK(rest["joints"][1]["position"] == nlohmann::json({-10.971, -53.014, 928.275}));
  CHECK(rest["joints"][1]["rotation_wxyz"] == nlohmann::json({1.0, 0.0, 0.0, 0.0}));

  CHECK(nlohmann::json::parse(test::run_limber({"fk", bvh, "--frame", "2751", "--json"}).out)["joints"].size() == 31);
  CHECK(test::run_limber({"fk", bvh, "--frame", "2752", "--json"}).exit_code == 1);
  CHECK(test::run_limber({"fk", rig, "--motion", bvh, "--frame", "9", "--json"}).exit_code == 0);
  CHECK(test::run_limber({"fk", rig, "--motion", bvh, "--frame", "9999"}).exit_code == 1);
  CHECK(test::run_limber({"fk", rig, "--flex", "LeftForearm=45"}).exit_code == 0);
  CHECK(test::run_limber({"fk", rig, "--flex", "LeftForearm=45x"}).exit_code == 1);
  CHECK(test::run_limber({"fk", rig, "--flex", "Wing=45"}).exit_code == 1);
  CHECK(test::run_limber({"fk", rig, "--frame", "4"}).exit_code == 1);

  const std::string walk = test::shared_path("data/bvh/mh_walk1.bvh").string();
  for (const std::vector<std::string>& of :
       {std::vector<std::string>{walk}, {rig, "--motion", walk, "--root-motion"}}) {
    const auto told = [&](std::vector<std::string> options) {
      options.insert(options.begin(), of.begin(), of.end());
      options.insert(options.begin(), "fk");
      options.push_back("--json");
      return nlohmann::json::parse(test::run_limber(options).out);
    };
    const auto all = told({"--all-frames"});
    REQUIRE(all["frames"].size() == 14);
    CHECK(all["frames"][11] == told({"--frame", "11"}));
  }
  CHECK(test::run_limber({"fk", rig, "--all-frames", "--json"}).exit_code == 1);
}
