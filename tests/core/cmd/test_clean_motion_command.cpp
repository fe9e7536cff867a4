// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <sstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/shared_data.h"

using namespace limber::test;

namespace {

using Places = std::vector<std::array<double, 3>>;

// Where a bone's head or tail is in each frame of a motion on a rig, as `limber fk` says.
Places track(const std::string& rig, const std::string& motion, const std::string& bone, const std::string& point) {
  const auto fk =
      run_limber({"fk", rig, "--motion", motion, "--up", "auto", "--root-motion", "--all-frames", "--json"});
  REQUIRE(fk.exit_code == 0);
  Places places;
  const auto told = nlohmann::json::parse(fk.out);
  for (const auto& frame : told["frames"])
    for (const auto& joint : frame["joints"])
      if (joint["name"] == bone) places.push_back(joint[point].get<std::array<double, 3>>());
  return places;
}

double along_ground(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

// The largest second difference of a track: what a jump would show, mm per frame^2.
double roughest(const Places& places) {
  double most = 0;
  for (std::size_t f = 1; f + 1 < places.size(); ++f)
    most = std::max(most, std::hypot(places[f - 1][0] - 2 * places[f][0] + places[f + 1][0],
                                     places[f - 1][1] - 2 * places[f][1] + places[f + 1][1],
                                     places[f - 1][2] - 2 * places[f][2] + places[f + 1][2]));
  return most;
}

}  // namespace

TEST_CASE(
    "clean-motion command: feet of real takes stay, a hand is on its target, and knees stay as smooth as before") {
  NEEDS_SHARED("data/bp3d/body.armature.json");
  NEEDS_SHARED("data/bvh/cmu_12_01_walk.bvh");
  const std::string rig = shared_path("data/bp3d/body.armature.json").string();
  const TemporaryFolder folder;
  for (const char* take : {"walk01_exponents", "cmu_12_01_walk", "fair1_dab"}) {
    CAPTURE(take);
    const std::string motion = shared_path("data/bvh/" + std::string(take) + ".bvh").string();
    const std::string smooth = (folder / "smooth.bvh").string(), clean = (folder / "clean.bvh").string();
    REQUIRE(run_limber({"clean-motion", rig, "--motion", motion, "--up", "auto", "--smooth", "6", "-o", smooth})
                .exit_code == 0);
    const Places free = track(rig, smooth, "LeftHand", "tail");
    // A place nearer to the elbow, which every arm can reach.
    const Places elbow = track(rig, smooth, "LeftForearm", "position");
    std::array<double, 3> target;
    for (int axis = 0; axis < 3; ++axis) target[axis] = free[40][axis] + 0.2 * (elbow[40][axis] - free[40][axis]);
    std::ostringstream hold;
    hold << "left hand=" << target[0] << "," << target[1] << "," << target[2] << "@38-42";
    const auto cleaned = run_limber({"clean-motion", rig, "--motion", motion, "--up", "auto", "--smooth", "6",
                                     "--plant-feet", "--hold", hold.str(), "-o", clean});
    REQUIRE(cleaned.exit_code == 0);

    int stances = 0;
    double slid = 0;
    const std::regex row("(left|right) foot +(tip|joint) +([0-9]+)-([0-9]+) +([0-9.]+) mm.*");
    std::istringstream lines(cleaned.out);
    for (std::string line; std::getline(lines, line);) {
      std::smatch part;
      if (!std::regex_match(line, part, row)) continue;
      CAPTURE(line);
      const Places places =
          track(rig, clean, part[1] == "left" ? "LeftFoot" : "RightFoot", part[2] == "tip" ? "tail" : "position");
      double slides = 0;
      const auto first = std::stoul(part[3]), last = std::stoul(part[4]);
      for (auto f = first; f <= last; ++f) slides = std::max(slides, along_ground(places[f], places[first]));
      CHECK(slides < 2);
      slid = std::max(slid, std::stod(part[5]));
      if (++stances == 6) break;  // each asks the program for all frames
    }
    CHECK(stances >= 4);
    CHECK(slid > 5);  // they slid before
    const Places hand = track(rig, clean, "LeftHand", "tail");
    for (int f = 38; f <= 42; ++f)
      CHECK(std::hypot(hand[f][0] - target[0], hand[f][1] - target[1], hand[f][2] - target[2]) < 3);
    for (const char* knee : {"LeftShank", "RightShank"})
      CHECK(roughest(track(rig, clean, knee, "position")) < 2 * roughest(track(rig, smooth, knee, "position")) + 15);
  }
}

TEST_CASE("clean-motion command: what cannot be cleaned is one clear line, and no file is left") {
  const TemporaryFolder folder;
  REQUIRE(run_limber({"phantom", "arm", "--spacing", "8", "-o", folder.path()}).exit_code == 0);
  const std::string rig = folder / "rig.json", motion = folder / "motion.bvh", out = folder / "clean.bvh";
  const auto refused = [&](std::vector<std::string> more, const std::string& why) {
    CAPTURE(why);
    std::vector<std::string> words{"clean-motion", rig, "--motion", motion, "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = run_limber(words);
    CHECK(run.exit_code == 1);
    CHECK(run.err.find(why) != std::string::npos);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK_FALSE(std::filesystem::exists(out));
  };
  refused({}, "nothing to clean");
  refused({"--smooth", "1e6"}, "cutoff frequency");
  refused({"--plant-feet"}, "no leg");
  refused({"--hold", "tail@0-1"}, "no limb of this name");
  refused({"--hold", "hand"}, "a hold is not understood");
  for (const char* value : {"hand=1,2@0-1", "hand=1,2,nan@0-1", "hand@0", "hand@0-", "hand@0.5-1", "hand=@0-1",
                            "hand=1,2,3@1-0", "hand=1e300,0,0@0-1", "hand@0-99999", "@", ""})
    refused({"--hold", value}, "--hold");
}
