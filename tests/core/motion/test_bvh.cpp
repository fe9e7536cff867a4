// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/bvh.h"

#include <cmath>
#include <fstream>
#include <numbers>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {
// Returns a BVH of two joints and an end site, with the given rows of values.
std::string chain(const std::string& rows, const std::string& frames = "1") {
  return "HIERARCHY\nROOT base\n{\n OFFSET 0 0 0\n CHANNELS 3 Xrotation Yrotation Zrotation\n JOINT tip\n {\n  OFFSET "
         "0 10 0\n"
         "  CHANNELS 3 Zrotation Xrotation Yrotation\n  End Site\n  {\n   OFFSET 0 5 0\n  }\n }\n}\nMOTION\nFrames: " +
         frames + "\nFrame Time: 0.01\n" + rows;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (size_t at = 0; (at = text.find(what, at)) != text.npos; at += by.size()) text.replace(at, what.size(), by);
  return text;
}

void check_same(const Motion& a, const Motion& b) {
  CHECK(a.joints == b.joints);
  CHECK(a.values == b.values);
  CHECK(a.frame_count == b.frame_count);
}

struct Difference {
  double position = 0;  // largest distance of a joint from its reference, as a share of the skeleton's extent
  double rotation = 0;  // largest angle of a joint from its reference, radians
};

Difference difference_to_reference(const std::filesystem::path& bvh, const std::filesystem::path& reference) {
  const Motion motion = read_bvh(bvh);
  std::ifstream in(reference);
  const nlohmann::json expected = nlohmann::json::parse(in);
  REQUIRE(expected["joints"].size() == motion.joints.size());
  CHECK(expected["frame_count"] == motion.frame_count);
  CHECK(expected["frame_time"].get<double>() == doctest::Approx(motion.frame_time).epsilon(1e-4));
  for (size_t j = 0; j < motion.joints.size(); ++j) {
    CHECK(expected["joints"][j] == motion.joints[j].name);
    CHECK(expected["parents"][j] == motion.joints[j].parent);
  }

  Difference largest;
  for (const auto& frame : expected["frames"]) {
    const auto world = forward_kinematics(motion, frame["frame"]);
    const std::vector<double> p = frame["position"], q = frame["rotation_wxyz"], e = frame["end_site"];
    glm::dvec3 low(p[0], p[1], p[2]), high = low;
    for (const auto& list : {p, e})
      for (size_t i = 0; i < list.size(); i += 3) {
        low = glm::min(low, glm::dvec3(list[i], list[i + 1], list[i + 2]));
        high = glm::max(high, glm::dvec3(list[i], list[i + 1], list[i + 2]));
      }
    const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
    for (size_t j = 0; j < world.size(); ++j) {
      const glm::dvec3 there(p[3 * j], p[3 * j + 1], p[3 * j + 2]);
      largest.position = std::max(largest.position, glm::length(world[j].translation - there) / extent);
      const glm::dquat turn =
          glm::conjugate(glm::dquat(q[4 * j], q[4 * j + 1], q[4 * j + 2], q[4 * j + 3])) * world[j].rotation;
      largest.rotation =
          std::max(largest.rotation, 2 * std::asin(std::min(1.0, glm::length(glm::dvec3(turn.x, turn.y, turn.z)))));
    }
    for (size_t i = 0; i < expected["leaf_joints"].size(); ++i) {
      const auto& leaf = expected["leaf_joints"][i];
      size_t j = 0;
      if (leaf.is_number()) j = leaf;
      else
        while (motion.joints[j].name != leaf.get<std::string>()) ++j;
      const glm::dvec3 end = world[j] * motion.joints[j].end_site.value();
      largest.position =
          std::max(largest.position, glm::length(end - glm::dvec3(e[3 * i], e[3 * i + 1], e[3 * i + 2])) / extent);
    }
  }
  return largest;
}
}  // namespace

TEST_CASE("bvh: rotations multiply in the order of the channels") {
  const Motion motion = parse_bvh(chain("90 0 0 90 0 0\n"), "test");
  const auto world = forward_kinematics(motion, 0);
  // A quarter turn about x takes the tip to +z. Then a quarter turn about the tip's own z takes its end site to -x.
  CHECK(glm::length(world[1].translation - glm::dvec3(0, 0, 10)) < 1e-12);
  CHECK(glm::length(world[1] * *motion.joints[1].end_site - glm::dvec3(-5, 0, 10)) < 1e-12);
}

TEST_CASE("bvh: line ends, tabs, case, glued braces, a byte order mark and exponents change nothing") {
  const std::string rows = "1 2 3 4 5 6\n-0.5 .25 1e1 +2 3. 4E-2\n";
  const Motion plain = parse_bvh(chain(rows, "2"), "test");
  CHECK(plain.frame_count == 2);
  CHECK(plain.warnings.empty());
  CHECK(plain.values[8] == 10);
  check_same(parse_bvh(replaced(chain(rows, "2"), "\n", "\r\n"), "test"), plain);
  check_same(parse_bvh(replaced(chain(rows, "2"), "\n", "\r"), "test"), plain);
  check_same(parse_bvh(replaced(chain(rows, "2"), " ", "\t "), "test"), plain);
  check_same(parse_bvh(replaced(chain(rows, "2"), "\n{", "{"), "test"), plain);
  check_same(parse_bvh(replaced(chain(rows, "2"), "\n }", "}"), "test"), plain);
  check_same(parse_bvh("\xEF\xBB\xBF" + chain(rows, "2"), "test"), plain);
  check_same(parse_bvh(replaced(replaced(chain(rows, "2"), "rotation", "ROTATION"), "JOINT", "joint"), "test"), plain);
  check_same(
      parse_bvh(replaced(replaced(chain(rows, "2"), "Frame Time:", "FRAME TIME :"), "Frames:", "frames :"), "test"),
      plain);
  check_same(parse_bvh(replaced(chain(rows, "2"), "3 4", "3\n4"), "test"), plain);
  CHECK(parse_bvh(replaced(chain(rows, "2"), "tip", "Bip01 L Hand "), "test").joints[1].name == "Bip01 L Hand");
}

TEST_CASE("bvh: a number of frames that disagrees keeps the whole frames and says so") {
  const std::string row = "1 2 3 4 5 6\n";
  for (const auto& [text, frames] : {std::pair{chain(row, "3"), 1},
                                     {chain(row + row, "1"), 2},
                                     {chain(row + "1 2 3", "2"), 1},
                                     {chain(row, "2147483647"), 1},
                                     {chain("1 2", "1"), 0}}) {
    const Motion motion = parse_bvh(text, "test");
    CHECK(motion.frame_count == frames);
    CHECK(motion.values.size() == size_t(6 * frames));
    CHECK(motion.warnings.size() == 1);
  }
}

TEST_CASE("bvh: without MOTION or frames it is a rig") {
  std::string text = chain("", "0");
  CHECK(parse_bvh(text, "test").frame_count == 0);
  text.resize(text.find("MOTION"));
  const Motion motion = parse_bvh(text, "test");
  CHECK(motion.frame_count == 0);
  CHECK(motion.warnings.empty());
  const Armature rig = armature_of(motion);
  CHECK(rig.bones[1].head == glm::dvec3(0, 0, 10));
  CHECK(rig.bones[1].tail == glm::dvec3(0, 0, 15));
}

TEST_CASE("bvh: what has no single meaning is refused with its line") {
  const std::string row = "1 2 3 4 5 6\n";
  auto refused = [](const std::string& text, const std::string& line) {
    try {
      parse_bvh(text, "file.bvh");
      FAIL("read without complaint: ", text);
    } catch (const Error& error) {
      CHECK_MESSAGE(std::string(error.what()).find(line) != std::string::npos, error.what());
    }
  };
  refused("", "line 1");
  refused("no bvh", "line 1");
  refused(chain("1 2 nan 4 5 6\n"), "line 19");
  refused(chain(row + "1 2 inf 4 5 6\n"), "line 20");
  refused(chain("1 2 1e999 4 5 6\n"), "line 19");
  refused(chain("1 2 1,5 4 5 6\n"), "line 19");
  refused(chain(row + "1 2 3 4 5 6 7\n" + row, "3"), "line 20");
  refused(chain(row + "1 2 3 4 5\n" + row, "3"), "line 21");
  refused(replaced(chain(row), "\n}\nMOTION", "\nMOTION"), "line 15");
  refused(replaced(chain(row), "\n}\nMOTION", "\n}\n}\nMOTION"), "line 16");
  refused(replaced(chain(row), "CHANNELS 3 X", "CHANNELS 7 X"), "line 5");
  refused(replaced(chain(row), "CHANNELS 3 X", "CHANNELS 2 X"), "line 5");
  refused(replaced(chain(row), "OFFSET 0 10 0", "OFFSET 0 ten 0"), "line 8");
  refused(replaced(chain(row), "Frames: 1", "Frames: -1"), "line 17");
  refused(replaced(chain(row), "Frame Time", "Time"), "line 18");
}

TEST_CASE("bvh: joints that share a name get names of their own") {
  const Motion motion = parse_bvh(replaced(chain("1 2 3 4 5 6\n"), "tip", "base"), "test");
  CHECK(motion.joints[0].name == "base");
  CHECK(motion.joints[1].name != "base");
  CHECK(motion.warnings.size() == 1);
}

TEST_CASE("bvh: a chain of 4096 joints is read, one more is refused") {
  auto long_chain = [](int joints) {
    std::string text = "HIERARCHY\nROOT j\n{\nOFFSET 0 0 0\n";
    for (int i = 1; i < joints; ++i)
      text += "JOINT j" + std::to_string(i) + "\n{\nOFFSET 1 0 0\nCHANNELS 1 Zrotation\n";
    return text + std::string(joints, '}');
  };
  CHECK(forward_kinematics(parse_bvh(long_chain(4096), "test"), -1).back().translation.x == 4095);
  CHECK_THROWS_AS(parse_bvh(long_chain(4097), "test"), Error);
}

TEST_CASE("bvh: what is written reads back the same") {
  const Motion motion = parse_bvh(chain("0.1 -2.5e-7 3 4 5 123.4567\n1 2 3 4 5 6\n", "2"), "test");
  check_same(parse_bvh(bvh_text(motion), "test"), motion);
}

TEST_CASE("bvh: a rig written as a hierarchy keeps names, heads and the tails of its ends") {
  const Armature rig{
      {{"arm", -1, {1, 2, 3}, {1, 2, 9}}, {"hand", 0, {1, 2, 9}, {4, 4, 4}}, {"other", 0, {0, 0, 0}, {1, 1, 1}}}};
  const Armature back = armature_of(parse_bvh(bvh_text(motion_of(rig)), "test"));
  REQUIRE(back.bones.size() == 3);
  for (size_t i = 0; i < 3; ++i) {
    CHECK(back.bones[i].name == rig.bones[i].name);
    CHECK(back.bones[i].parent == rig.bones[i].parent);
    CHECK(glm::length(back.bones[i].head - rig.bones[i].head) < 1e-12);
    if (i > 0) CHECK(glm::length(back.bones[i].tail - rig.bones[i].tail) < 1e-12);
  }
}

TEST_CASE("bvh: places and rotations agree with Blender's importer") {
  for (const auto& [bvh, reference] : {std::pair{"reference/bvh/odd_orders.bvh", "odd_orders"},
                                       {"reference/bvh/six_channels.bvh", "six_channels"},
                                       {"reference/bvh/two_roots.bvh", "two_roots"},
                                       {"data/bvh/walk01_exponents.bvh", "walk01"},
                                       {"data/bvh/freebvh_fingers.bvh", "test_freebvh"}}) {
    NEEDS_SHARED(bvh);
    const Difference off = difference_to_reference(
        test::shared_path(bvh), test::shared_path(std::string("reference/bvh/") + reference + ".json"));
    const std::string file = bvh;
    CAPTURE(file);
    CAPTURE(off.position);
    CAPTURE(off.rotation);
    CHECK(off.position < 1e-5);
    CHECK(off.rotation < 2e-5);  // the importer turns bones in single precision
  }
}

TEST_CASE("bvh: joints with one, two or no channels turn by those they have") {
  NEEDS_SHARED("reference/bvh/partial_channels.bvh");
  const Motion motion = read_bvh(test::shared_path("reference/bvh/partial_channels.bvh"));
  CHECK(motion.channel_count == 9);
  CHECK(motion.frame_count == 5);
  const auto world = forward_kinematics(motion, 0);
  auto about = [](const glm::dvec3& axis, double degrees) {
    return glm::angleAxis(degrees * std::numbers::pi / 180, axis);
  };
  const glm::dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const glm::dquat root = about(z, -49.1791) * about(x, -1.42052) * about(y, 4.2772);
  const glm::dquat hinge = root * about(x, 39.9988), two = hinge * about(z, 47.7468) * about(y, -5.7344);
  CHECK(glm::length(world[0].translation - glm::dvec3(21.6781, -79.0218, 45.7734)) < 1e-5);
  CHECK(glm::length(world[3].translation -
                    (world[0].translation + root * (5.0 * y) + hinge * (4.0 * y) + two * (3.0 * y))) < 1e-4);
  CHECK(world[3].rotation == world[2].rotation);
}
