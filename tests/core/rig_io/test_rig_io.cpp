// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig_io/rig_io.h"

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "tests/support/program.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {
Armature arm_with_limits() {
  Armature arm;
  arm.bones.push_back({"Upper \"arm\" ä", -1, {0.1, 1.0 / 3, -2e-7}, {10.25, 0, 30}, 0.3, {}});
  arm.bones.push_back({"Forearm",
                       0,
                       {10.25, 0, 30},
                       {1e5, 7, 1},
                       0,
                       {JointLimits::Type::Hinge, glm::normalize(glm::dvec3(1, 2, 3)), -0.1, 2.4}});
  arm.bones.push_back(
      {"Hand", 1, {1e5, 7, 1}, {1e5, 7, 9}, -1, {JointLimits::Type::Ball, {0, 0, 1}, 0, 0, 1.25, -0.5, 0.75}});
  arm.bones.push_back({"Watch", 1, {3, 7, 1}, {3, 7, 9}, 0, {JointLimits::Type::Fixed}});
  return arm;
}
}  // namespace

TEST_CASE("armature: what is written as JSON reads back equal, limits and roll included") {
  const test::TemporaryFolder scratch;
  write_armature(arm_with_limits(), scratch / "first.json");
  const Armature read = read_armature(scratch / "first.json");
  write_armature(read, scratch / "second.json");
  CHECK(read_armature(scratch / "second.json") == read);
  CHECK(read_file(scratch / "first.json") == read_file(scratch / "second.json"));

  const Armature arm = arm_with_limits();
  REQUIRE(read.bones.size() == arm.bones.size());
  for (size_t i = 0; i < arm.bones.size(); ++i) {
    CHECK(read.bones[i].name == arm.bones[i].name);
    CHECK(read.bones[i].head == arm.bones[i].head);
    CHECK(read.bones[i].tail == arm.bones[i].tail);
    CHECK(read.bones[i].roll == arm.bones[i].roll);
    CHECK(read.bones[i].limits.type == arm.bones[i].limits.type);
    CHECK(read.bones[i].limits.maximum == doctest::Approx(arm.bones[i].limits.maximum).epsilon(1e-15));
  }
}

TEST_CASE("armature: a Bender .vtk keeps names, parents and places") {
  const test::TemporaryFolder scratch;
  write_armature(arm_with_limits(), scratch / "arm.vtk");
  const Armature read = read_armature(scratch / "arm.vtk"), arm = arm_with_limits();
  REQUIRE(read.bones.size() == arm.bones.size());
  for (size_t i = 0; i < arm.bones.size(); ++i) {
    CHECK(read.bones[i].name == arm.bones[i].name);
    CHECK(read.bones[i].parent == arm.bones[i].parent);
    CHECK(read.bones[i].head == arm.bones[i].head);
    CHECK(read.bones[i].tail == arm.bones[i].tail);
  }
}

TEST_CASE("armature: children may be listed before their parents") {
  const Armature rig = parse_armature_json(R"({"bones": [
    {"name": "hand", "parent": "arm", "head": [0, 0, 1], "tail": [0, 0, 2]},
    {"name": "arm", "parent": null, "head": [0, 0, 0], "tail": [0, 0, 1]}]})",
                                           "test");
  CHECK(rig.bones[0].name == "arm");
  CHECK(rig.bones[1].name == "hand");
  CHECK(rig.bones[1].parent == 0);
}

TEST_CASE("armature: space and unit are turned to LPS mm") {
  const Armature rig = parse_armature_json(R"({"space": "RAS", "unit": "cm", "bones": [
    {"name": "arm", "parent": null, "head": [1, 2, 3], "tail": [0, 0, 1]}]})",
                                           "test");
  CHECK(rig.bones[0].head == glm::dvec3(-10, -20, 30));
}

TEST_CASE("armature: rigs that contradict themselves are refused") {
  auto refused = [](const char* text) { CHECK_THROWS_AS(parse_armature_json(text, "test"), Error); };
  refused("");
  refused("[]");
  refused("{");
  refused(R"({"bones": []})");
  refused(R"({"bones": [{"name": "a", "head": [0, 0], "tail": [0, 0, 1]}]})");
  refused(R"({"bones": [{"name": "a", "head": [0, 0, 1e999], "tail": [0, 0, 1]}]})");
  refused(R"({"bones": [{"name": "a", "parent": "a", "head": [0, 0, 0], "tail": [0, 0, 1]}]})");
  refused(R"({"bones": [{"name": "a", "parent": "b", "head": [0, 0, 0], "tail": [0, 0, 1]}]})");
  refused(
      R"({"bones": [{"name": "a", "parent": null, "head": [0, 0, 0], "tail": [0, 0, 1]}, {"name": "a",
        "parent": null, "head": [0, 0, 0], "tail": [0, 0, 1]}]})");
  refused(
      R"({"bones": [{"name": "a", "parent": "b", "head": [0, 0, 0], "tail": [0, 0, 1]}, {"name": "b", "parent": "a",
        "head": [0, 0, 0], "tail": [0, 0, 1]}]})");
  refused(
      R"({"bones": [{"name": "a", "head": [0, 0, 0], "tail": [0, 0, 1], "limits": {"type": "hinge",
        "axis": [0, 0, 0], "minimum_degrees": 0, "maximum_degrees": 1}}]})");
  refused(R"({"unit": "parsec", "bones": [{"name": "a", "head": [0, 0, 0], "tail": [0, 0, 1]}]})");
}

TEST_CASE("armature: the arm of the paper has 21 bones, the forearm below the upper arm") {
  NEEDS_SHARED("data/bender/man-arm-2mm-armature.vtk");
  const Armature arm = read_armature(test::shared_path("data/bender/man-arm-2mm-armature.vtk"));
  CHECK(arm.bones.size() == 21);
  const Bone& forearm = arm.bones[require_bone(arm, "Forearm")];
  CHECK(arm.bones[forearm.parent].tail == forearm.head);
  CHECK(forearm.head == glm::dvec3(99.8076, 80.8065, -9.62028));
}
