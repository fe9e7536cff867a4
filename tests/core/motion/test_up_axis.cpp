// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/up_axis.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/motion/motion_edit.h"
#include "core/rig_io/rig_io.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"
#include "tests/support/walker.h"

namespace limber::test {

namespace {

Motion z_up_from_y_up(const Motion& motion) { return y_up_from_z_up(y_up_from_z_up(y_up_from_z_up(motion))); }

// Returns the motion as some files store it: at rest the body lies along z, and an added root joint turns it upright in
// every frame.
Motion upright_by_its_root(const Motion& z_up) {
  Motion motion = z_up;
  motion.joints.insert(motion.joints.begin(), {.name = "World", .channels = {BvhChannel::Xrotation}});
  for (std::size_t j = 1; j < motion.joints.size(); ++j) {
    ++motion.joints[j].parent;
    ++motion.joints[j].first_channel;
  }
  motion.values.clear();
  for (int frame = 0; frame < z_up.frame_count; ++frame) {
    motion.values.push_back(-90);
    const auto row = z_up.values.begin() + static_cast<std::ptrdiff_t>(frame) * z_up.channel_count;
    motion.values.insert(motion.values.end(), row, row + z_up.channel_count);
  }
  ++motion.channel_count;
  return motion;
}

}  // namespace

TEST_CASE("up axis: a body that stands along z is found, and stands along y once it is turned") {
  const Motion y_up = t_pose_body({{0, 0, 0}, {2, 5, 1}, {3, 10, 2}}), z_up = z_up_from_y_up(y_up);
  CHECK(up_axis_of(y_up) == UpGuess{UpAxis::Y, UpGuess::By::Frames});
  CHECK(up_axis_of(z_up) == UpGuess{UpAxis::Z, UpGuess::By::Frames});
  CHECK(up_axis_of(y_up_from_z_up(z_up)).axis == UpAxis::Y);
  CHECK(up_axis_of(upright_by_its_root(z_up)) == UpGuess{UpAxis::Y, UpGuess::By::Frames});

  Motion rest = z_up;
  rest.frame_count = 0;
  rest.values.clear();
  CHECK(up_axis_of(rest) == UpGuess{UpAxis::Z, UpGuess::By::Rest});
}

TEST_CASE(
    "up axis: where names say nothing the ground is what the take travels along, and nothing is said of one that "
    "stays") {
  Motion motion;
  motion.joints = {{.name = "a", .channels = {BvhChannel::Xposition, BvhChannel::Yposition, BvhChannel::Zposition}},
                   {.name = "b", .parent = 0, .offset = {0, 0, 3}}};
  motion.channel_count = 3;
  CHECK(up_axis_of(motion) == UpGuess{});
  for (int frame = 0; frame < 20; ++frame)
    for (float value : {0.5f * frame, 2.0f * frame, 0.3f * (frame % 2)}) motion.values.push_back(value);
  motion.frame_count = 20;
  CHECK(up_axis_of(motion) == UpGuess{UpAxis::Z, UpGuess::By::Travel});
  CHECK(up_axis_of(y_up_from_z_up(motion)) == UpGuess{UpAxis::Y, UpGuess::By::Travel});
  for (float& value : motion.values) value *= 0.01f;
  CHECK(up_axis_of(motion) == UpGuess{});
}

TEST_CASE("up axis: of the real takes those made in Blender's axes are found, and no other") {
  NEEDS_SHARED("data/bvh/mh_walk1.bvh");
  const std::set<std::string> z_up{"mh_walk1", "mh_tpose_6ch", "fair1_dab", "bvh_test1_mixed_orders"};
  for (const auto& entry : std::filesystem::directory_iterator(shared_path("data/bvh"))) {
    if (entry.path().extension() != ".bvh") continue;
    const std::string name = entry.path().stem().string();
    CAPTURE(name);
    const Motion motion = read_bvh(entry.path());
    const UpGuess guess = up_axis_of(motion);
    CHECK((guess.axis == UpAxis::Z) == z_up.contains(name));
    if (guess.axis == UpAxis::Z) CHECK(up_axis_of(y_up_from_z_up(motion)).axis == UpAxis::Y);
  }
}

TEST_CASE(
    "command line: a motion is read with y up, with a warning where it stands along z, and with z up when asked") {
  const TemporaryFolder folder;
  const Motion y_up = t_pose_body({{0, 0, 0}, {20, 5, 1}});
  write_armature(hanging_body(), folder / "rig.json");
  write_bvh(y_up, folder / "y.bvh");
  write_bvh(z_up_from_y_up(y_up), folder / "z.bvh");
  const auto posed = [&](const char* file, std::vector<std::string> more) {
    std::vector<std::string> words{"fk", folder / "rig.json", "--motion", folder / file, "--frame", "1", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_limber(words);
  };
  const auto right = posed("y.bvh", {});
  CHECK(right.err.empty());
  CHECK(posed("y.bvh", {"--up", "auto"}).out == right.out);
  const auto wrong = posed("z.bvh", {});
  CHECK(wrong.exit_code == 0);
  CHECK(wrong.out != right.out);
  CHECK(wrong.err.find("add --up z\n") != std::string::npos);
  CHECK(std::count(wrong.err.begin(), wrong.err.end(), '\n') == 1);
  const auto joints = nlohmann::json::parse(right.out)["joints"];
  for (const char* up : {"z", "auto"}) {
    const auto turned = posed("z.bvh", {"--up", up});
    CHECK(turned.err.empty());
    const auto other = nlohmann::json::parse(turned.out)["joints"];
    for (std::size_t j = 0; j < joints.size(); ++j)
      for (int axis = 0; axis < 3; ++axis)
        CHECK(other[j]["position"][axis].get<double>() ==
              doctest::Approx(joints[j]["position"][axis].get<double>()).epsilon(1e-4));
  }
  CHECK(posed("z.bvh", {"--up", "x"}).exit_code == 2);
}

}  // namespace limber::test
