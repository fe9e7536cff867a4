// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig_io/bender_rig.h"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/rigid_transform.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {
bool is_near(const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b) < 1e-5; }
}  // namespace

TEST_CASE("bender armature: an .arm gives heads and tails from the parent's tail in the parent's axes") {
  // The first bone points along z, the second along the first one's own y, the third along the second one's x.
  const Armature rig = parse_bender_arm(R"(<?xml version="1.0"?><armature name="a" orientation="0 0 0 1">
    <bone name="first &amp; last" head="1 2 3" tail="1 2 13" orientation="0.70710678 0 0 0.70710678">
      <pose rotation="0 0 0 1"/>
      <bone name="on" head="0 0 0" tail="0 5 0" orientation="0 0 0 1">
        <bone name="aside" head="0 0 0" tail="4 0 0" orientation="0 0 -0.70710678 0.70710678"/></bone></bone>
          </armature>)",
                                        "test");
  REQUIRE(rig.bones.size() == 3);
  CHECK(rig.bones[0].name == "first & last");
  CHECK(is_near(rig.bones[0].head, {-1, -2, 3}));
  CHECK(is_near(rig.bones[0].tail, {-1, -2, 13}));
  CHECK(is_near(rig.bones[1].head, {-1, -2, 13}));
  CHECK(is_near(rig.bones[1].tail, {-1, -2, 18}));
  CHECK(is_near(rig.bones[2].tail, {-5, -2, 18}));
  CHECK(rig.bones[2].parent == 1);
}

TEST_CASE("bender armature: the roll is the one that gives the bone's own axes") {
  const Armature rig = parse_bender_arm(
      R"(<armature><bone name="b" head="0 0 0" tail="0 3 0" orientation="0 0.38268343 0 0.92387953"/></armature>)",
      "test");
  // The orientation is a rotation by 45 degrees about y. It takes x to (1, 0, -1) in RAS, which is (-1, 0, -1) in LPS.
  const glm::dvec3 x = rest_axes(rig.bones[0])[0];
  CHECK(is_near(x, glm::normalize(glm::dvec3(-1, 0, -1))));
}

TEST_CASE("bender armature: XML that is cut, nested wrongly, without numbers or without bones is refused") {
  auto refused = [](const char* text) { CHECK_THROWS_AS(parse_bender_arm(text, "test"), Error); };
  refused("");
  refused("<armature>");
  refused("<armature/>");
  refused("<bone name=\"a\" head=\"0 0 0\" tail=\"0 0 1\"/>");
  refused("<armature><bone name=\"a\" head=\"0 0\" tail=\"0 0 1\"/></armature>");
  refused("<armature><bone name=\"a\" head=\"0 0 nan\" tail=\"0 0 1\"/></armature>");
  refused("<armature><bone name=\"a\" head=\"0 0 0 0\" tail=\"0 0 1\"/></armature>");
  refused("<armature><bone name=\"a\" head=\"0 0 0\" tail=\"0 0 1\" orientation=\"0 0 0 0\"/></armature>");
  refused("<armature><bone head=\"0 0 0\" tail=\"0 0 1\"/></armature>");
}

TEST_CASE("bender armature: .vtk files that are cut or point outside themselves are refused") {
  const std::string whole = bender_vtk_text({{{"a", -1, {0, 0, 0}, {0, 0, 1}}, {"b", 0, {0, 0, 1}, {0, 0, 2}}}});
  CHECK(parse_bender_vtk(whole, "test").bones.size() == 2);
  const size_t needed = whole.find("RestToPoseRotation");
  for (size_t size = 0; size < needed; size += 7)
    CHECK_THROWS_AS(parse_bender_vtk(whole.substr(0, size), "test"), Error);
  auto refused = [&](const std::string& what, const std::string& by) {
    std::string text = whole;
    CHECK_THROWS_AS(parse_bender_vtk(text.replace(text.find(what), what.size(), by), "test"), Error);
  };
  refused("2 2 3", "2 2 4");
  refused("2 2 3", "3 2 3");
  refused("-1\n0\n", "-1\n2\n");
  refused("-1\n0\n", "1\n0\n");
  refused("ASCII", "BINARY");
  refused("POINTS 4", "POINTS 4000000000");
  refused("POLYDATA", "STRUCTURED_POINTS");
}

TEST_CASE("bender armature: chains of Bender's .arm files join, and their left is left") {
  NEEDS_SHARED("data/bender/HumanArmature.arm");
  const Armature rig = read_armature(test::shared_path("data/bender/HumanArmature.arm"));
  CHECK(rig.bones.size() == 29);
  for (const Bone& bone : rig.bones)
    if (bone.parent >= 0) CHECK(glm::length(bone.head - rig.bones[bone.parent].tail) < 0.1);
  const glm::dvec3 skull = rig.bones[require_bone(rig, "skull")].tail, sacrum = rig.bones[0].head;
  CHECK(skull.z - sacrum.z > 8);
  const double left = rig.bones[require_bone(rig, "unlaL")].head.x,
               right = rig.bones[require_bone(rig, "unlaR")].head.x;
  CHECK(left * right < 0);
}

TEST_CASE("bender armature: every bone of the paper's arm ends in tissue") {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  const auto file = read_volume(test::shared_path("data/bender/man-arm-2mm.mha"));
  const Armature arm = read_armature(test::shared_path("data/bender/man-arm-2mm-armature.vtk"));
  const Grid& grid = file.volume.grid;
  const glm::dmat3 voxel_from_world = glm::inverse(glm::dmat3(
      grid.direction[0] * grid.spacing.x, grid.direction[1] * grid.spacing.y, grid.direction[2] * grid.spacing.z));
  for (const Bone& bone : arm.bones)
    for (const glm::dvec3& end : {bone.head, bone.tail}) {
      const glm::ivec3 v(glm::round(voxel_from_world * (end - grid.origin)));
      const bool inside = glm::all(glm::greaterThanEqual(v, glm::ivec3(0))) && glm::all(glm::lessThan(v, grid.size));
      REQUIRE(inside);
      CHECK(file.volume.voxels[v.x + std::int64_t(grid.size.x) * (v.y + std::int64_t(grid.size.y) * v.z)] != 0);
    }
}
