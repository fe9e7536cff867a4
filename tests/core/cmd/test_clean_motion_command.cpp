// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>
#include <sstream>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/motion/bvh.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"

using namespace limber::test;

namespace {

using Places = std::vector<std::array<double, 3>>;

// Returns the position of a bone's head or tail in each frame of a motion on a rig, as `limber fk` prints it.
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

// Returns the largest second difference of a track, mm per frame^2. A jump makes it large.
double roughest(const Places& places) {
  double most = 0;
  for (std::size_t f = 1; f + 1 < places.size(); ++f)
    most = std::max(most, std::hypot(places[f - 1][0] - 2 * places[f][0] + places[f + 1][0],
                                     places[f - 1][1] - 2 * places[f][1] + places[f + 1][1],
                                     places[f - 1][2] - 2 * places[f][2] + places[f + 1][2]));
  return most;
}

}  // namespace

TEST_CASE("clean-motion command: feet of real takes stay, a hand is on its target, and knees stay as smooth as before" *
          doctest::test_suite("slow")) {
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
    // The target lies nearer to the elbow than the hand does, so that every arm can reach it.
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
      if (++stances == 6) break;  // six stances are enough: each takes a run of `limber fk`
    }
    CHECK(stances >= 4);
    CHECK(slid > 5);  // mm: a foot did slide before cleaning
    const Places hand = track(rig, clean, "LeftHand", "tail");
    for (int f = 38; f <= 42; ++f)
      CHECK(std::hypot(hand[f][0] - target[0], hand[f][1] - target[1], hand[f][2] - target[2]) < 3);
    for (const char* knee : {"LeftShank", "RightShank"})
      CHECK(roughest(track(rig, clean, knee, "position")) < 2 * roughest(track(rig, smooth, knee, "position")) + 15);
  }
}

TEST_CASE("clean-motion command: a walk is mirrored, made faster, and repeated without a jump at the seam" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bp3d/body.armature.json");
  NEEDS_SHARED("data/bvh/cmu_12_01_walk.bvh");
  const std::string rig = shared_path("data/bp3d/body.armature.json").string();
  const TemporaryFolder folder;
  const auto made = [&](const std::string& from, const char* name, std::vector<std::string> more) {
    const std::string to = (folder / name).string();
    std::vector<std::string> words{"clean-motion", rig, "--motion", from, "--up", "auto", "-o", to};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = run_limber(words);
    CAPTURE(run.err);
    REQUIRE(run.exit_code == 0);
    return to;
  };
  const std::string walk = made(shared_path("data/bvh/cmu_12_01_walk.bvh").string(), "walk.bvh", {"--smooth", "6"});
  // From frame kFirst on, the recording has two steps that take kSteps frames together. Then the body is back in its
  // first pose. Loops are blended over kSeam frames.
  constexpr int kFirst = 174, kSteps = 152, kSeam = 36;
  limber::Motion cycle = limber::read_bvh(walk);
  cycle.values.erase(cycle.values.begin() + (kFirst + kSteps + 1) * cycle.channel_count, cycle.values.end());
  cycle.values.erase(cycle.values.begin(), cycle.values.begin() + kFirst * cycle.channel_count);
  cycle.frame_count = kSteps + 1;
  limber::write_bvh(cycle, folder / "cycle.bvh");
  const std::string mirrored = made((folder / "cycle.bvh").string(), "mirrored.bvh", {"--mirror"}),
                    twice = made(mirrored, "twice.bvh", {"--mirror"}),
                    fast = made((folder / "cycle.bvh").string(), "fast.bvh", {"--speed", "2"}),
                    loop = made((folder / "cycle.bvh").string(), "loop.bvh", {"--loop", "3", "--seam", "36"}),
                    spot = made((folder / "cycle.bvh").string(), "spot.bvh", {"--loop", "3", "--on-the-spot"});
  const auto apart = [](const auto& a, const auto& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); };
  for (const char* bone : {"Pelvis", "LeftFoot", "RightFoot", "LeftHand", "RightShank"}) {
    CAPTURE(bone);
    const Places take = track(rig, (folder / "cycle.bvh").string(), bone, "tail"),
                 again = track(rig, twice, bone, "tail"), faster = track(rig, fast, bone, "tail"),
                 looped = track(rig, loop, bone, "tail");
    REQUIRE(take.size() == kSteps + 1);
    REQUIRE(faster.size() == kSteps / 2 + 1);
    REQUIRE(looped.size() == 3 * kSteps + 1);
    for (std::size_t f = 0; f < take.size(); ++f) CHECK(apart(take[f], again[f]) < 0.01);
    for (std::size_t f = 0; f < faster.size(); ++f) CHECK(apart(take[2 * f], faster[f]) < 0.01);
    const auto fastest = [&](const Places& places, int from, int to) {
      double most = 0;
      for (int f = from; f < to; ++f) most = std::max(most, apart(places[f], places[f + 1]));
      return most;
    };
    const double sides = std::max(fastest(take, 0, kSeam / 2), fastest(take, kSteps - kSeam / 2, kSteps));
    for (const int seam : {kSteps, 2 * kSteps}) {
      CHECK(fastest(looped, seam - kSeam / 2, seam + kSeam / 2) < 1.5 * sides);
      const double before = apart(looped[seam - 1], looped[seam]), after = apart(looped[seam], looped[seam + 1]);
      CHECK(std::abs(after - before) < 0.5);  // change of speed, mm per frame; it is up to 2 in the recording itself
    }
    CHECK(apart(looped[kSteps], looped[2 * kSteps]) == doctest::Approx(apart(looped[0], looped[kSteps])).epsilon(0.02));
    const Places still = track(rig, spot, bone, "tail");
    for (std::size_t f = 0; f + kSteps < still.size(); ++f) CHECK(apart(still[f], still[f + kSteps]) < 0.01);
  }
  // The left foot of the mirrored walk moves like the right foot of the original, up to the difference between the
  // legs.
  const Places left = track(rig, mirrored, "LeftFoot", "position"),
               right = track(rig, (folder / "cycle.bvh").string(), "RightFoot", "position");
  double most = 0, lifted = 0;
  for (std::size_t f = 0; f < left.size(); ++f) {
    most = std::max(most, std::abs(left[f][2] - right[f][2]));
    lifted = std::max(lifted, left[f][2] - left[0][2]);
  }
  CHECK(most < 10);
  CHECK(lifted > 50);
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
  refused({"--loop", "2", "--seam", "100000"}, "the blend at the seam is longer");
  refused({"--hold", "tail@0-1"}, "no limb of this name");
  refused({"--hold", "hand"}, "the value of --hold is not valid");
  for (const char* value : {"hand=1,2@0-1", "hand=1,2,nan@0-1", "hand@0", "hand@0-", "hand@0.5-1", "hand=@0-1",
                            "hand=1,2,3@1-0", "hand=1e300,0,0@0-1", "hand@0-99999", "@", ""})
    refused({"--hold", value}, "--hold");
}
