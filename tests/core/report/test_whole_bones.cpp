// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/whole_bones.h"

#include <random>

#include <doctest/doctest.h>

#include "core/binding/rigid.h"
#include "core/bones/bone_parts.h"
#include "tests/core/skin/small_body.h"

using namespace limber;
using namespace limber::test;

namespace {
// Makes the bar with two bones as a thigh and a shank, with labels that name them.
SmallBody named_bar() {
  SmallBody body = two_bone_bar();
  const int middle = body.volume.grid.size.z / 2;
  for (std::int64_t at = 0; at < std::ssize(body.volume.voxels); ++at)
    if (body.volume.voxels[at] == kBone && at / (body.volume.grid.size.x * body.volume.grid.size.y) >= middle)
      body.volume.voxels[at] = 3;
  body.tissues.tissues.push_back(body.tissues.tissues[1]);
  body.tissues.tissues[1].name = "Left femur";
  body.tissues.tissues[2].name = "Left tibia";
  body.tissues.tissues[2].label = 3;
  body.tissues.tissues[2].file_value = 3;
  body.armature.bones[0].name = "LeftThigh";
  body.armature.bones[1].name = "LeftShank";
  return body;
}

std::vector<WholeBone> judged(const SmallBody& body, const SmallBody& bound_as, double degrees) {
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(bound_as.volume, tissue, bound_as.tissues, bound_as.armature);
  const SkinWeights weights = bind_rigid(bound_as.volume, tissue, bound_as.armature, parts);
  const std::vector<RigidTransform> motions = {
      {}, rotation_about(body.armature.bones[1].head, glm::angleAxis(glm::radians(degrees), glm::dvec3(1, 0, 0)))};
  return whole_bones(body.volume, tissue, body.tissues, body.armature, weights, motions);
}
}  // namespace

TEST_CASE("whole bones: bones that follow their own rig bones are whole and none is astray") {
  const SmallBody body = named_bar();
  const auto bones = judged(body, body, 90);
  REQUIRE(bones.size() == 2);
  for (const WholeBone& bone : bones) {
    CHECK(bone.voxels > 0);
    CHECK(bone.wrong_voxels == 0);
    CHECK(bone.residual_mm == 0);
  }
  CHECK(bones[0].belongs_to == "LeftThigh");
  CHECK(bones[1].belongs_to == "LeftShank");
  CHECK(astray_bones(bones).empty());
}

TEST_CASE("whole bones: a bone that went whole with the wrong rig bone is caught, though it is rigid") {
  const SmallBody body = named_bar();
  SmallBody swapped = body;
  swapped.tissues.tissues[2].name = "Left femur";  // binds the shank's bone to the thigh
  const auto bones = judged(body, swapped, 90);
  CHECK(bones[1].wrong_voxels == bones[1].voxels);
  CHECK(bones[1].went_with == "LeftThigh");
  CHECK(bones[1].residual_mm == 0);
  const auto lines = astray_bones(bones);
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].find("Left tibia") != std::string::npos);
}

TEST_CASE("whole bones: a bone torn between two rig bones has a residual as large as the tear") {
  const SmallBody body = named_bar();
  SmallBody half = body;
  for (std::int64_t at = 0; at < std::ssize(half.volume.voxels); ++at)
    if (half.volume.voxels[at] == 3 && at / (half.volume.grid.size.x * half.volume.grid.size.y) < 32)
      half.volume.voxels[at] = kBone;
  const auto bones = judged(body, half, 60);
  CHECK(bones[1].wrong_voxels > 0);
  CHECK(bones[1].wrong_voxels < bones[1].voxels);
  CHECK(bones[1].residual_mm > 2);
}

TEST_CASE("whole bones: the best rigid motion finds a motion from its own points, and no mirror image") {
  std::mt19937 random(3);
  std::normal_distribution<double> number;
  for (int trial = 0; trial < 20; ++trial) {
    RigidTransform motion;
    motion.rotation = glm::normalize(glm::dquat(number(random), number(random), number(random), number(random)));
    motion.translation = {10 * number(random), 10 * number(random), 10 * number(random)};
    std::vector<glm::dvec3> rest, posed, mirrored;
    for (int k = 0; k < 12; ++k) {
      rest.emplace_back(50 * number(random), 50 * number(random), 50 * number(random));
      posed.push_back(motion * rest.back());
      mirrored.push_back(rest.back() * glm::dvec3(-1, 1, 1));
    }
    const RigidTransform found = best_rigid_motion(rest, posed);
    for (const glm::dvec3& p : rest) CHECK(glm::distance(found * p, motion * p) < 1e-9);
    CHECK(glm::determinant(glm::mat3_cast(best_rigid_motion(rest, mirrored).rotation)) == doctest::Approx(1));
  }
}
