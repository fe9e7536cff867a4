// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/retarget.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/motion/motion_edit.h"
#include "core/motion/same_skeleton.h"
#include "core/rig/mirror.h"
#include "core/rig_io/rig_io.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"
#include "tests/support/walker.h"

using namespace limber;
using namespace limber::test;

namespace {
glm::dvec3 posed_direction(const Armature& rig, const std::vector<RigidTransform>& posed, const char* bone) {
  const int b = require_bone(rig, bone);
  return glm::normalize(posed[b].rotation * (rig.bones[b].tail - rig.bones[b].head));
}

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
}

// Compares by how much each rig bone, and the joint of the motion that is mapped to it, have turned since frame 0.
// Returns the largest difference over all such bones and every `step`-th frame, in degrees.
double largest_difference(const Motion& motion, const Armature& rig, int step, const RetargetMap& map,
                          Travel travel = Travel::Locked) {
  const Retarget retarget(motion, rig, map, {.travel = travel});
  const auto rig_start = posed_from_rest(rig, retarget.at(0));
  const auto source_start = forward_kinematics(motion, 0);
  double largest = 0;
  for (int frame = 0; frame < motion.frame_count; frame += step) {
    const auto posed = posed_from_rest(rig, retarget.at(frame));
    const auto source = forward_kinematics(motion, frame);
    for (size_t b = 0; b < rig.bones.size(); ++b) {
      const int j = retarget.joint_of(static_cast<int>(b));
      if (j < 0) continue;
      const glm::dquat here = posed[b].rotation * glm::conjugate(rig_start[b].rotation);
      const glm::dquat there = lps_from_bvh(source[j].rotation * glm::conjugate(source_start[j].rotation));
      const glm::dquat off = here * glm::conjugate(there);
      largest = std::max(largest, 2 * std::atan2(glm::length(glm::dvec3(off.x, off.y, off.z)), std::abs(off.w)));
    }
  }
  return largest * 180 / std::numbers::pi;
}
double largest_difference(const Motion& motion, const Armature& rig, int step) {
  return largest_difference(motion, rig, step, match_by_names(motion, rig));
}

// How far feet slide on the ground while the recorded foot stands, mm: `source` is the sum for the recorded foot,
// `posed` the sum for the foot of the posed body in the same frames.
struct Drift {
  double source = 0, posed = 0;
  // `stances` counts the times in which the recorded foot stands; `longer` counts those in which the posed foot slides
  // more than 2 % and 1 mm further than the recorded foot.
  int stances = 0, longer = 0;
};
Drift drift_of(const Motion& motion, const std::vector<glm::dvec3>& source, const std::vector<glm::dvec3>& posed) {
  // A foot stands while it is slower than kStill (mm/s) and less than kLow (mm) above its lowest position, for at least
  // kShortest (s).
  constexpr double kStill = 100, kLow = 30, kShortest = 0.1;
  double ground = 1e9;
  for (const glm::dvec3& place : source) ground = std::min(ground, place.z);
  const auto stands = [&](size_t frame) {
    return glm::length(glm::dvec2(source[frame] - source[frame - 1])) < kStill * motion.frame_time &&
           source[frame].z < ground + kLow;
  };
  Drift drift;
  for (size_t begin = 0, end; begin + 1 < source.size(); begin = end) {
    double theirs = 0, ours = 0;
    for (end = begin + 1; end < source.size() && stands(end); ++end) {
      theirs = std::max(theirs, glm::length(glm::dvec2(source[end] - source[begin])));
      ours = std::max(ours, glm::length(glm::dvec2(posed[end] - posed[begin])));
    }
    if (double(end - 1 - begin) * motion.frame_time < kShortest) continue;
    drift.source += theirs;
    drift.posed += ours;
    ++drift.stances;
    drift.longer += ours > 1.02 * theirs + 1;
  }
  return drift;
}
}  // namespace

TEST_CASE("retarget: an actor in T-pose spreads the arms of a rig that rests with hanging arms") {
  const Motion motion = t_pose_body({{0, 0, 0}});
  const Armature rig = hanging_body();
  const auto posed = posed_from_rest(rig, Retarget(motion, rig, match_by_names(motion, rig)).at(0));
  for (const char* bone : {"LeftUpperArm", "LeftForearm", "LeftHand"})
    CHECK(degrees_between(posed_direction(rig, posed, bone), {1, 0, 0}) < 1e-6);
  for (const char* bone : {"RightUpperArm", "RightForearm"})
    CHECK(degrees_between(posed_direction(rig, posed, bone), {-1, 0, 0}) < 1e-6);
  CHECK(degrees_between(posed_direction(rig, posed, "LeftShank"), {0, 0, -1}) < 1e-6);
  // The trunk keeps its shape and the feet their pitch.
  CHECK(degrees_between(posed_direction(rig, posed, "SpineTop"), {0, 0, 1}) < 1e-6);
  const glm::dvec3 foot = posed_direction(rig, posed, "LeftFoot");
  CHECK(foot.x == doctest::Approx(0).epsilon(1e-9));
  CHECK(foot.z == doctest::Approx(-80 / std::sqrt(110.0 * 110 / 30.25 + 80 * 80 + 150 * 150)).epsilon(0.02));
}

TEST_CASE("retarget: matched bones turn as their joints do, whatever the frame") {
  const Motion motion = t_pose_body({{0, 0, 0}, {10, 20, 30}, {-50, 15, 5}, {80, -40, 120}});
  CHECK(largest_difference(motion, hanging_body(), 1) < 1e-5);
}

TEST_CASE("retarget: a spine of three takes the bend of two without a jump") {
  const Motion motion = t_pose_body({{0, 30, 0}});
  const Armature rig = hanging_body();
  const Retarget retarget(motion, rig, match_by_names(motion, rig));
  const auto posed = posed_from_rest(rig, retarget.at(0));
  CHECK(retarget.joint_of(require_bone(rig, "SpineTop")) >= 0);
  double bend = 0, largest = 0;
  const char* chain[] = {"Pelvis", "SpineLow", "SpineMiddle", "SpineTop"};
  for (int i = 1; i < 4; ++i) {
    const double step =
        degrees_between(posed_direction(rig, posed, chain[i - 1]), posed_direction(rig, posed, chain[i]));
    bend += step;
    largest = std::max(largest, step);
  }
  CHECK(bend ==
        doctest::Approx(degrees_between(posed_direction(rig, posed, "Pelvis"), posed_direction(rig, posed, "SpineTop")))
            .epsilon(0.02));
  CHECK(largest < 0.6 * bend);
}

TEST_CASE("retarget: in place the root stays, with root motion it travels scaled by the legs") {
  const Motion motion = t_pose_body({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  const Armature rig = hanging_body();
  const RetargetMap map = match_by_names(motion, rig);
  CHECK(Retarget(motion, rig, map).at(2).root_translation == glm::dvec3(0));
  const Retarget travelling(motion, rig, map, {.travel = Travel::Free});
  CHECK(travelling.scale() == doctest::Approx(820.0 / 8).epsilon(1e-6));
  CHECK(glm::length(travelling.at(2).root_translation - glm::dvec3(2 * 820.0 / 8, 0, 0)) < 1e-4);
  CHECK(Retarget(motion, rig, map, {.travel = Travel::InPlace}).at(2).root_translation ==
        glm::dvec3(0, 0, travelling.at(2).root_translation.z));
  CHECK(Retarget(motion, rig, map, {.travel = Travel::Free, .scale = 10}).at(2).root_translation.x ==
        doctest::Approx(20));
}

TEST_CASE("retarget: in the mirror each side does what the other one did") {
  const Motion motion = t_pose_body({{0, 0, 0}, {10, 20, 30}});
  const Armature rig = hanging_body();
  const RetargetMap map = match_by_names(motion, rig);
  const Pose plain = Retarget(motion, rig, map).at(1), mirrored = Retarget(motion, rig, map, {.mirror = true}).at(1);
  CHECK(mirrored == flipped(plain, rig));
  CHECK_FALSE(mirrored == plain);
}

TEST_CASE("retarget: a map of one's own is read, written and held to what is there") {
  const Motion motion = t_pose_body({{0, 30, 0}});
  const Armature rig = hanging_body();
  const RetargetMap map = parse_retarget_map(
      R"({"Spine": ["SpineLow", "SpineMiddle"], "Neck": {"bone": "Neck", "rest_offset_wxyz": [2, 0, 0, 0]},
        "Chest": null})",
      "test", motion, rig);
  CHECK(map.joint_of("SpineMiddle") == "Spine");
  CHECK(map.sources.at("Neck").rest_offset == glm::dquat(1, 0, 0, 0));
  CHECK(map.joint_of("Pelvis").empty());

  const test::TemporaryFolder folder;
  const RetargetMap found = Retarget(motion, rig, match_by_names(motion, rig)).map();
  write_retarget_map(found, folder / "map.json");
  const RetargetMap again = read_retarget_map(folder / "map.json", motion, rig);
  CHECK(Retarget(motion, rig, again).at(0) == Retarget(motion, rig, found).at(0));

  auto refused = [&](const char* text) { CHECK_THROWS_AS(parse_retarget_map(text, "test", motion, rig), Error); };
  refused("");
  refused("{}");
  refused(R"({"Tail": "Pelvis"})");
  refused(R"({"Hips": "Wing"})");
  refused(R"({"Hips": 3})");
  refused(R"({"Hips": "Pelvis", "Spine": "Pelvis"})");
  refused(R"({"Hips": {"bone": "Pelvis", "rest_offset_wxyz": [0, 0, 0, 0]}})");
}

namespace {

// Writes poses of a rig to BVH, changes and reads them back, and returns the largest differences of bones' rotations
// (degrees) and of joints' positions (mm).
std::pair<double, double> lost_in_a_file(const Armature& rig, const std::vector<Pose>& poses,
                                         const std::function<Motion(Motion)>& changed) {
  const Motion written =
      motion_of_poses(rig, static_cast<int>(poses.size()), 30, [&](int frame) { return poses[frame]; });
  const Motion motion = changed(parse_bvh(bvh_text(written), "again"));
  const Retarget retarget(motion, rig, match_by_names(motion, rig), {.travel = Travel::Free});
  double turned = 0, moved = 0;
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    const auto before = posed_from_rest(rig, poses[frame]),
               after = posed_from_rest(rig, retarget.at(static_cast<int>(frame)));
    for (std::size_t b = 0; b < rig.bones.size(); ++b) {
      const glm::dquat off = before[b].rotation * glm::conjugate(after[b].rotation);
      turned =
          std::max(turned, glm::degrees(2 * std::atan2(glm::length(glm::dvec3(off.x, off.y, off.z)), std::abs(off.w))));
      moved = std::max(moved, glm::distance(before[b] * rig.bones[b].head, after[b] * rig.bones[b].head));
    }
  }
  return {turned, moved};
}

std::vector<Pose> random_poses(const Armature& rig, int count) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Pose> poses(count, rest_pose(rig));
  for (Pose& pose : poses) {
    pose.root_translation = 200.0 * glm::dvec3(normal(random), normal(random), normal(random));
    for (glm::dquat& turn : pose.rotation)
      turn = glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
  }
  return poses;
}

}  // namespace

TEST_CASE(
    "retarget: a motion written for the rig comes back as it was, also in other units or axes, but no other is taken "
    "for one") {
  std::vector<Armature> rigs{hanging_body()};
  if (const auto file = test::shared_path("data/makehuman/body.armature.json"); std::filesystem::exists(file))
    rigs.push_back(read_armature(file));
  for (const Armature& rig : rigs) {
    const std::vector<Pose> poses = random_poses(rig, 5);
    const auto [turned, moved] = lost_in_a_file(rig, poses, [](const Motion& motion) { return motion; });
    CHECK(turned < 1e-4);
    CHECK(moved < 0.1);

    std::vector<Pose> in_place = poses;
    for (Pose& pose : in_place) pose.root_translation = {0, 0, 0};
    const auto [turned_small, moved_small] = lost_in_a_file(rig, in_place, [](Motion motion) {
      for (BvhJoint& joint : motion.joints) {
        joint.offset *= 0.1;
        if (joint.end_site) *joint.end_site *= 0.1;
        for (std::size_t c = 0; c < joint.channels.size(); ++c)
          for (int frame = 0; joint.channels[c] < BvhChannel::Xrotation && frame < motion.frame_count; ++frame)
            motion.values[static_cast<std::size_t>(frame) * motion.channel_count + joint.first_channel + c] *= 0.1f;
      }
      return motion;
    });
    CHECK(turned_small < 1e-4);
    CHECK(moved_small < 0.1);
  }

  const Armature rig = hanging_body();
  const Motion own = motion_of_poses(rig, 1, 30, [&](int) { return rest_pose(rig); });
  CHECK(same_skeleton(y_up_from_z_up(own), rig));
  CHECK_FALSE(same_skeleton(y_up_from_z_up(own), rig)->in_place);
  CHECK_FALSE(same_skeleton(t_pose_body({{0, 0, 0}}), rig));
  Motion longer = own;
  longer.joints.back().offset *= 1.1;
  CHECK_FALSE(same_skeleton(longer, rig));
}

TEST_CASE("retarget: real motions keep the directions of matched bones on real rigs") {
  for (const char* file : {"data/bvh/cmu_01_01.bvh", "data/bvh/rokoko_jesse_dance.bvh"})
    for (const char* rig_file : {"data/bp3d/body.armature.json", "data/makehuman/body.armature.json"}) {
      NEEDS_SHARED(file);
      NEEDS_SHARED(rig_file);
      const std::string names = std::string(file) + " on " + rig_file;
      CAPTURE(names);
      CHECK(largest_difference(read_bvh(test::shared_path(file)), read_armature(test::shared_path(rig_file)), 7) <
            1e-4);
    }
}

TEST_CASE("retarget: feet that stand slide no more than the source's, stance by stance, and stand as high" *
          doctest::test_suite("slow")) {
  for (const char* file : {"data/bvh/cmu_12_01_walk.bvh", "data/bvh/freebvh_fingers.bvh", "data/bvh/mocapbank_crlf.bvh",
                           "data/bvh/cmu_01_01.bvh", "data/bvh/Boxing_Toes.bvh"})
    for (const char* rig_file : {"data/bp3d/body.armature.json", "data/makehuman/body.armature.json"}) {
      NEEDS_SHARED(file);
      NEEDS_SHARED(rig_file);
      const std::string names = std::string(file) + " on " + rig_file;
      CAPTURE(names);
      const Motion motion = read_bvh(test::shared_path(file));
      const Armature rig = read_armature(test::shared_path(rig_file));
      const RetargetMap map = match_by_names(motion, rig);
      const Retarget retarget(motion, rig, map, {.travel = Travel::Free});
      const std::array<int, 2> bones{require_bone(rig, "LeftFoot"), require_bone(rig, "RightFoot")};
      std::array<std::vector<glm::dvec3>, 2> source, posed;
      for (int frame = 0; frame < motion.frame_count; ++frame) {
        const auto joints = forward_kinematics(motion, frame);
        const auto motions = posed_from_rest(rig, retarget.at(frame));
        for (int i : {0, 1}) {
          REQUIRE(retarget.joint_of(bones[i]) >= 0);
          source[i].push_back(retarget.scale() * lps_from_bvh(joints[retarget.joint_of(bones[i])].translation));
          posed[i].push_back(motions[bones[i]] * rig.bones[bones[i]].head);
        }
      }
      Drift all;
      double higher = 0;
      int frames = 0;
      for (int i : {0, 1}) {
        const Drift drift = drift_of(motion, source[i], posed[i]);
        all.source += drift.source;
        all.posed += drift.posed;
        all.stances += drift.stances;
        all.longer += drift.longer;
        double ground = 1e9;
        for (const glm::dvec3& place : source[i]) ground = std::min(ground, place.z);
        for (size_t f = 0; f < source[i].size(); ++f) {
          if (source[i][f].z > ground + 30) continue;
          higher += std::abs(posed[i][f].z - rig.bones[bones[i]].head.z - (source[i][f].z - ground));
          ++frames;
        }
      }
      MESSAGE(names, ": ", all.stances, " stances, mm strayed ", all.posed, ", the source's ", all.source);
      CHECK(all.stances > 2);
      CHECK(all.longer == 0);
      CHECK(all.posed < 1.01 * all.source + 0.5);  // sums over the whole recording, mm
      CHECK(higher / frames < 15);                 // mean error of the height of low feet, mm
      CHECK(largest_difference(motion, rig, 7, map, Travel::Free) < 2);
    }
}

TEST_CASE("retarget: toes that stand while the heel is up slide no more than the source's, and ankles all the same" *
          doctest::test_suite("slow")) {
  for (const std::string file : {"data/bvh/Boxing_Toes.bvh", "data/bvh/cmu_12_01_walk.bvh", "data/bvh/cmu_01_01.bvh",
                                 "data/bvh/freebvh_fingers.bvh"})
    for (const auto& [rig_file, toes] : {std::pair{"data/bp3d/body.armature.json", "Toes"},
                                         std::pair{"data/makehuman/body.armature.json", "ToeBase"}}) {
      NEEDS_SHARED(file);
      NEEDS_SHARED(rig_file);
      const Motion motion = read_bvh(test::shared_path(file));
      const Armature rig = read_armature(test::shared_path(rig_file));
      const Retarget retarget(motion, rig, match_by_names(motion, rig), {.travel = Travel::Free});
      Drift all;
      for (const std::string side : {"Left", "Right"}) {
        const int bone = require_bone(rig, side + toes);
        REQUIRE(retarget.joint_of(bone) >= 0);
        std::vector<glm::dvec3> source, posed;
        for (int frame = 0; frame < motion.frame_count; ++frame) {
          source.push_back(retarget.scale() *
                           lps_from_bvh(forward_kinematics(motion, frame)[retarget.joint_of(bone)].translation));
          posed.push_back(posed_from_rest(rig, retarget.at(frame))[bone] * rig.bones[bone].head);
        }
        const Drift drift = drift_of(motion, source, posed);
        all.source += drift.source;
        all.posed += drift.posed;
        all.stances += drift.stances;
        all.longer += drift.longer;
      }
      MESSAGE(file, " on ", std::string(rig_file), ": ", all.stances, " stances, mm strayed ", all.posed,
              ", the source's ", all.source);
      CHECK(all.stances > 3);
      CHECK(all.longer == 0);
      CHECK(all.posed < 1.02 * all.source + 1);
    }
}

TEST_CASE("retarget: joints that are named like nothing move what a map of one's own says") {
  for (const auto& [rig_file, text] :
       {std::pair{"data/bp3d/body.armature.json",
                  R"({"base": "Pelvis", "child1": "LeftUpperArm", "child2": "LeftForearm", "child3": "LeftHand"})"},
        std::pair{"data/makehuman/body.armature.json",
                  R"({"base": "Hips", "child1": "Spine", "child2": "RightArm", "child3": "RightForeArm"})"}}) {
    NEEDS_SHARED("data/bvh/sinusoidal_no_endsite.bvh");
    NEEDS_SHARED(rig_file);
    const Motion motion = read_bvh(test::shared_path("data/bvh/sinusoidal_no_endsite.bvh"));
    const Armature rig = read_armature(test::shared_path(rig_file));
    CHECK_THROWS_AS(match_by_names(motion, rig), Error);
    const RetargetMap map = parse_retarget_map(text, "own.json", motion, rig);
    CHECK(map.sources.size() == 4);
    for (const Travel travel : {Travel::Locked, Travel::Free})
      CHECK(largest_difference(motion, rig, 1, map, travel) < 1e-5);
  }
}

TEST_CASE("retarget: real motions find the limbs of real rigs") {
  struct Expected {
    const char *motion, *rig, *bone, *joint;
  };
  for (const Expected& e : {Expected{"cmu_01_01", "bp3d/body", "LeftClavicle", "LeftShoulder"},
                            {"cmu_01_01", "bp3d/body", "LeftUpperArm", "LeftArm"},
                            {"cmu_01_01", "bp3d/body", "RightShank", "RightLeg"},
                            {"cmu_01_01", "bp3d/body", "ThoraxUpper", "Spine1"},
                            {"rokoko_jesse_dance", "bp3d/body", "LeftIndexMiddle", "LeftHandIndex2"},
                            {"rokoko_jesse_dance", "bp3d/body", "RightToes", "RightToeBase"},
                            {"mocapbank_crlf", "bp3d/body", "LeftUpperArm", "LeftShoulder"},
                            {"mocapbank_crlf", "bp3d/body", "LeftThigh", "LeftHip"},
                            {"freebvh_fingers", "makehuman/body", "LeftArm", "mixamorig:LeftArm"},
                            {"mh_tpose_6ch", "bp3d/body", "LeftThigh", "upperleg01.L"},
                            {"mh_walk1", "bp3d/body", "RightThigh", "UpLeg_R"}}) {
    const std::string motion_file = std::string("data/bvh/") + e.motion + ".bvh",
                      rig_file = std::string("data/") + e.rig + ".armature.json";
    NEEDS_SHARED(motion_file);
    NEEDS_SHARED(rig_file);
    const RetargetMap map =
        match_by_names(read_bvh(test::shared_path(motion_file)), read_armature(test::shared_path(rig_file)));
    CHECK_MESSAGE(map.joint_of(e.bone) == e.joint, e.motion, " moves ", e.bone, " by ", map.joint_of(e.bone));
  }
}
