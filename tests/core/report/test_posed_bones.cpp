// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/posed_bones.h"

#include <functional>

#include <doctest/doctest.h>

#include "core/rig/pose.h"
#include "tests/support/figure.h"

using namespace limber;
using namespace limber::test;

namespace {
// The bones of the figure in a pose. The test chooses which rig bone each part of a bone moves with, and reads each
// posed voxel back along that motion.
struct PosedFigure {
  Figure figure = block_figure();
  LabelVolume posed;
  ZeroedVector<glm::vec3> displacement;
  std::vector<RigidTransform> asked;

  JudgedPose judged() const {
    JudgedPose pose{figure.volume, posed, figure.tissues, {displacement.data(), displacement.size()}, &figure.armature};
    pose.asked = pose.applied = asked;
    return pose;
  }
};

using MovesWith = std::function<int(Label label, const glm::ivec3& rest)>;

PosedFigure pose_figure(const std::vector<std::pair<const char*, double>>& degrees_about_x,
                        const MovesWith& moves_with) {
  PosedFigure body;
  Pose pose = rest_pose(body.figure.armature);
  for (const auto& [bone, degrees] : degrees_about_x)
    pose.rotation[*body.figure.armature.find(bone)] = glm::angleAxis(glm::radians(degrees), glm::dvec3(1, 0, 0));
  body.asked = posed_from_rest(body.figure.armature, pose);
  const Grid& rest = body.figure.volume.grid;
  body.posed.grid = rest;
  body.posed.grid.size += glm::ivec3(0, 160, 0);
  body.posed.grid.origin.y -= 80 * rest.spacing.y;
  body.posed.voxels.assign(body.posed.grid.voxel_count(), 0);
  body.displacement.resize(body.posed.voxels.size());
  const AffineTransform to_world = world_from_voxel(body.posed.grid), to_rest = voxel_from_world(rest);
  std::int64_t at = 0;
  for (int z = 0; z < body.posed.grid.size.z; ++z)
    for (int y = 0; y < body.posed.grid.size.y; ++y)
      for (int x = 0; x < body.posed.grid.size.x; ++x, ++at)
        for (std::size_t b = 0; b < body.asked.size(); ++b) {
          const glm::dvec3 here = to_world * glm::dvec3(x, y, z), there = inverse(body.asked[b]) * here;
          const glm::ivec3 v(glm::floor(to_rest * there + 0.5));
          const Label label = body.figure.volume.at_or_air(v);
          if (label < kLeftFemur || label > kVertebrae || moves_with(label, v) != int(b)) continue;
          body.posed.voxels[at] = label;
          body.displacement[at] = here - there;
        }
  return body;
}

int own_bone(Label label, const glm::ivec3&) {
  switch (label) {
    case kLeftFemur: return 6;
    case kLeftTibia: return 7;
    case kRightFemur: return 8;
    case kRightTibia: return 9;
    case kLeftHumerus: return 2;
    case kLeftUlna: return 3;
    case kRightHumerus: return 4;
    case kRightUlna: return 5;
    case kVertebrae: return 1;
    default: return 0;
  }
}

const WholeBone& of(const PosedBoneMeasures& bones, Label label) {
  for (const WholeBone& one : bones.whole)
    if (one.label == label) return one;
  FAIL("no bone " << label);
  return bones.whole.front();
}
}  // namespace

TEST_CASE("posed bones: bones that went with their own rig bones are whole, and each limb points where it was asked") {
  // The thigh turns up and the shank back, so the shank hangs as at rest.
  const PosedFigure body = pose_figure({{"LeftThigh", -60}, {"LeftShank", 60}}, own_bone);
  const PosedBoneMeasures bones = measure_posed_bones(body.judged());
  CHECK(bones.whole.size() == 11);
  for (const WholeBone& one : bones.whole) {
    CHECK(one.voxels > 50);
    CHECK(one.wrong_voxels == 0);
    CHECK(one.residual_mm < 1e-3);
    CHECK(one.went_with.empty());
  }
  CHECK(of(bones, kLeftTibia).belongs_to == "LeftShank");
  REQUIRE(bones.limbs.size() == 2);  // limbs that do not turn are not measured
  for (const LimbDirection& limb : bones.limbs) {
    CHECK(limb.by_name);
    CHECK(limb.direction_degrees < 1e-3);
    CHECK(limb.orientation_degrees < 1e-3);
  }
}

TEST_CASE("posed bones: a bone that went whole with another rig bone is rigid, and wrong to the last voxel") {
  const PosedFigure body = pose_figure({{"LeftThigh", -60}}, [](Label label, const glm::ivec3& v) {
    return label == kLeftHip ? 6 : own_bone(label, v);
  });
  const PosedBoneMeasures bones = measure_posed_bones(body.judged());
  const WholeBone& hip = of(bones, kLeftHip);
  CHECK(hip.residual_mm < 1e-3);
  CHECK(double(hip.wrong_voxels) > 0.8 * double(hip.voxels));  // voxels near the hip's axis hardly move
  CHECK(hip.belongs_to == "Pelvis");
  CHECK(hip.went_with == "LeftThigh");
  CHECK(of(bones, kLeftFemur).wrong_voxels == 0);
}

TEST_CASE("posed bones: a bone cut in two is as far from one motion as its halves went apart") {
  const PosedFigure body = pose_figure({{"LeftShank", 90}}, [](Label label, const glm::ivec3& v) {
    return label == kLeftFemur && v.z < 34 ? 7 : own_bone(label, v);
  });
  const WholeBone femur = of(measure_posed_bones(body.judged()), kLeftFemur);
  CHECK(femur.residual_mm > 15);
  CHECK(femur.went_with == "LeftShank");
  CHECK(femur.wrong_voxels > 0);
  CHECK(femur.wrong_voxels < femur.voxels);
}

TEST_CASE("posed bones: a pose that was not reached shows in the limbs' directions, by as much as is missing") {
  PosedFigure body = pose_figure({{"LeftForearm", -50}}, own_bone);
  Pose asked = rest_pose(body.figure.armature);
  asked.rotation[3] = glm::angleAxis(glm::radians(-62.0), glm::dvec3(1, 0, 0));
  JudgedPose pose = body.judged();
  pose.asked = posed_from_rest(body.figure.armature, asked);
  const PosedBoneMeasures bones = measure_posed_bones(pose);
  REQUIRE(bones.limbs.size() == 1);
  CHECK(bones.limbs[0].bone == "LeftForearm");
  CHECK(bones.limbs[0].direction_degrees == doctest::Approx(12).epsilon(0.001));
  for (const WholeBone& one : bones.whole) CHECK(one.wrong_voxels == 0);
}

TEST_CASE("posed bones: without names the bone around the middle of a limb tells its direction") {
  PosedFigure body = pose_figure({{"RightForearm", -40}}, own_bone);
  for (Tissue& tissue : body.figure.tissues.tissues)
    if (is_bone(tissue.kind)) tissue.name = "Bone";
  const PosedBoneMeasures bones = measure_posed_bones(body.judged());
  CHECK(bones.whole.empty());
  REQUIRE(bones.limbs.size() == 1);
  CHECK_FALSE(bones.limbs[0].by_name);
  CHECK(bones.limbs[0].direction_degrees < 1e-3);

  // Here the ulna moves with the upper arm (rig bone 4), so the forearm's 40 degrees are missing.
  PosedFigure left = pose_figure({{"RightForearm", -40}}, [](Label label, const glm::ivec3& v) {
    return label == kRightUlna ? 4 : own_bone(label, v);
  });
  left.figure.tissues = body.figure.tissues;
  CHECK(measure_posed_bones(left.judged()).limbs.at(0).direction_degrees == doctest::Approx(40).epsilon(0.001));
}

TEST_CASE(
    "posed bones: where no label has a name, another bone that passes beside a limb's shaft does not turn the limb") {
  PosedFigure body = pose_figure({{"LeftThigh", -60}}, [](Label label, const glm::ivec3& v) {
    return label == kLeftFemur && (v.x + v.y) % 3 == 0 ? 0 : own_bone(label, v);  // a third of the voxels stay
  });
  for (Tissue& tissue : body.figure.tissues.tissues) tissue.name = "bone";
  const PosedBoneMeasures bones = measure_posed_bones(body.judged());
  REQUIRE(bones.limbs.size() == 2);
  CHECK(bones.limbs[0].bone == "LeftThigh");
  CHECK_FALSE(bones.limbs[0].by_name);
  CHECK(bones.limbs[0].direction_degrees < 1e-3);
}
