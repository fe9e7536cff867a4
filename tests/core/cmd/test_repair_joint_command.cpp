// SPDX-License-Identifier: AGPL-3.0-or-later
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

using namespace limber::test;

namespace {

struct PhantomFiles {
  TemporaryFolder folder;
  std::string volume = folder / "volume.nrrd", rig = folder / "rig.json", tissues = folder / "tissues.json",
              weights = folder / "w.nrrd", repaired = folder / "repaired.nrrd";

  PhantomFiles() {
    REQUIRE(run_limber({"phantom", "arm", "--spacing", "5", "-o", folder.path()}).exit_code == 0);
    REQUIRE(run_limber({"weights", volume, "--rig", rig, "-o", weights}).exit_code == 0);
  }

  // Returns |skin| + |fat| + |muscle| volume change in %, from the voxel counts in the report of a resampling.
  double sum_by_report(const std::string& with, const std::string& degrees) const {
    const std::string report = folder / "report.json";
    REQUIRE(run_limber({"resample", volume, "--rig", rig, "--tissues", tissues, "--weights", with, "--flex",
                        "Forearm=" + degrees, "--glide", "off", "--method", "dqs", "--report", report, "-o",
                        folder / "posed.nrrd"})
                .exit_code == 0);
    std::ifstream in(report), table(tissues);
    const auto kinds = nlohmann::json::parse(table), told = nlohmann::json::parse(in);
    std::map<std::string, std::pair<double, double>> voxels;
    for (const auto& tissue : told["tissues"]) {
      auto& [before, after] = voxels[kinds[std::to_string(tissue["label"].get<int>())]["kind"].get<std::string>()];
      before += tissue["voxels_before"].get<double>();
      after += tissue["voxels_after"].get<double>();
    }
    double sum = 0;
    for (const char* kind : {"skin", "fat", "muscle"}) {
      INFO(kind, " at ", degrees);
      REQUIRE(voxels[kind].first > 0);
      sum += 100 * std::abs(voxels[kind].second / voxels[kind].first - 1);
    }
    return sum;
  }
};

}  // namespace

TEST_CASE("repair-joint command: the written weights keep more volume by the report of a resampling") {
  const PhantomFiles arm;
  const auto run =
      run_limber({"repair-joint", arm.volume, "--rig", arm.rig, "--tissues", arm.tissues, "--weights", arm.weights,
                  "--bone", "Forearm", "--range", "0,90", "--method", "dqs", "-o", arm.repaired});
  REQUIRE(run.exit_code == 0);
  CHECK(run.out.find("The joint of Forearm: the volumes of skin, fat and muscle change by") != std::string::npos);
  double before = 0, after = 0;
  for (const char* degrees : {"35", "60", "85"}) {
    before += arm.sum_by_report(arm.weights, degrees);
    after += arm.sum_by_report(arm.repaired, degrees);
  }
  CHECK(after < 0.7 * before);
}

TEST_CASE("repair-joint command: what cannot be repaired is one clear line, and no file is left") {
  const PhantomFiles arm;
  for (const auto& [bone, range, say] : {std::tuple{"UpperArm", "0,90", "choose a bone that has a parent"},
                                         {"Forearm", "20,90", "such as 0,90"},
                                         {"Elbow", "0,90", "Elbow"}}) {
    const auto run = run_limber(
        {"repair-joint", arm.volume, "--rig", arm.rig, "--bone", bone, "--range", range, "-o", arm.repaired});
    CHECK(run.exit_code == 1);
    CAPTURE(run.err);
    CHECK(run.err.find(say) != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(arm.repaired));
  }
}
