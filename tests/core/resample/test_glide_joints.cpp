// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/glide_joints.h"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/resample/pose_path.h"
#include "core/resample/resample.h"

using namespace limber;

namespace {

constexpr Label kBone = 1, kFlesh = 2;

// Two bars of bone in flesh, in voxels of 2 mm, that meet end to end at x = 0 with a thin joint between them. The hinge
// lies in the middle of their section, so bending drives a corner of one bar into the other. A third bone hangs on the
// second.
struct Bars {
  LabelVolume volume{{.size = {61, 61, 20}, .spacing = {2, 2, 2}, .origin = {-60, -60, -20}},
                     ZeroedVector<Label>(61 * 61 * 20)};
  TissueTable tissues;
  Armature armature;
  LabelSet is_bone = LabelSet(65536, 0);
  TissueVoxels tissue;
  SkinWeights weights;

  explicit Bars(double hinge_y = 0) {
    for (int z = 3; z < 17; ++z)
      for (int y = 18; y < 43; ++y)
        for (int x = 2; x < 59; ++x) volume.at({x, y, z}) = kFlesh;
    for (int z = 6; z < 14; ++z)
      for (int y = 25; y < 36; ++y)
        for (int x = 6; x < 55; ++x)
          if (x != 30) volume.at({x, y, z}) = kBone;
    tissues.tissues = {{.label = kBone, .name = "bone", .kind = TissueKind::CorticalBone},
                       {.label = kFlesh, .name = "muscle", .kind = TissueKind::Muscle}};
    armature.bones.push_back({"fixed", -1, {-48, 0, 0}, {0, hinge_y, 0}, 0, {}});
    armature.bones.push_back({"turning", 0, {0, hinge_y, 0}, {30, 0, 0}, 0, {}});
    armature.bones.push_back({"tip", 1, {30, 0, 0}, {48, 0, 0}, 0, {}});
    is_bone[kBone] = 1;
    tissue = TissueVoxels(volume);
    weights = SkinWeights({"fixed", "turning", "tip"}, tissue);
    for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
      std::vector<Influence> influences;
      tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& v) {
        influences.push_back(rigid_influence(v.x <= 30 ? 0 : v.x < 46 ? 1 : 2));
      });
      weights.set_chunk(brick, influences);
    }
  }

  Pose bent(double degrees) const {
    Pose pose = rest_pose(armature);
    pose.rotation[1] = glm::angleAxis(degrees * std::numbers::pi / 180, glm::dvec3(0, 0, 1));
    return pose;
  }
  GlidedPose glide(const Pose& pose, const GlideSettings& settings = {.most_mm = 15}) const {
    return glide_joints(volume, tissue, is_bone, weights, armature, pose, settings);
  }
  std::int64_t bone_in_bone(const Pose& pose) const {
    return resample(volume, tissues, armature, weights, pose, Blend::Linear).report.bone_overlap_voxels;
  }
};

}  // namespace

TEST_CASE("glide: bones that a pose drives into each other come apart, and keep the directions that were asked") {
  const Bars bars;
  const Pose pose = bars.bent(60);
  const GlidedPose glided = bars.glide(pose);
  REQUIRE(glided.joints.size() == 1);
  const GlidedJoint& joint = glided.joints[0];
  CHECK(joint.bone == "turning");
  CHECK(joint.against == "fixed");
  CHECK(joint.free);
  CHECK(joint.depth_before > 3);
  CHECK(joint.depth_after <= 0.1);
  CHECK(glm::length(joint.shift) < 15);
  CHECK(std::abs(joint.shift.z) < 0.1);

  CHECK(glided.pose.rotation == pose.rotation);
  const auto asked = posed_from_rest(bars.armature, pose), shifted = posed_from_rest(bars.armature, glided.pose);
  for (int bone = 0; bone < 3; ++bone) {
    CHECK(std::abs(glm::dot(asked[bone].rotation, shifted[bone].rotation)) == doctest::Approx(1).epsilon(1e-12));
    // The joint's shift moves all bones below the joint, but not bone 0 above it.
    const glm::dvec3 expected = bone == 0 ? glm::dvec3(0) : joint.shift;
    CHECK(glm::distance(shifted[bone].translation - asked[bone].translation, expected) < 1e-9);
  }
  const std::int64_t before = bars.bone_in_bone(pose), after = bars.bone_in_bone(glided.pose);
  CHECK(before > 100);
  CHECK(after * 5 < before);
}

TEST_CASE("glide: a joint whose bones do not overlap stays as it is, bit for bit") {
  const Bars bars(12);  // the hinge lies at the edge towards which the bars bend
  const Pose pose = bars.bent(60);
  const GlidedPose glided = bars.glide(pose);
  CHECK(glided.joints.empty());
  CHECK(glided.pose == pose);
  const Bars others;
  CHECK(others.glide(rest_pose(others.armature)).pose == rest_pose(others.armature));
}

TEST_CASE("glide: the bound is kept, and what would need more is said to overlap still") {
  const Bars bars;
  const GlidedPose glided = bars.glide(bars.bent(80), {.most_mm = 2});
  REQUIRE(glided.joints.size() == 1);
  CHECK_FALSE(glided.joints[0].free);
  CHECK(glided.joints[0].most_mm == 2);
  CHECK(glm::length(glided.joints[0].shift) <= 2 + 1e-9);
  CHECK(glided.joints[0].depth_after < glided.joints[0].depth_before);
  CHECK(glided.joints[0].depth_after > 1);
  // Without a bound in mm, the bound is a share of the shorter bone, here the turning one.
  CHECK(bars.glide(bars.bent(80), {.most_share = 0.1}).joints.at(0).most_mm == doctest::Approx(3));
}

TEST_CASE("glide: a shift is of the posed body, whatever the bones above have turned by") {
  const Bars bars;
  Pose turned = bars.bent(60);
  turned.rotation[0] = glm::angleAxis(1.1, glm::normalize(glm::dvec3(1, 2, 0.5)));
  turned.root_translation = {5, -3, 8};
  const GlidedPose straight = bars.glide(bars.bent(60)), glided = bars.glide(turned);
  REQUIRE(glided.joints.size() == 1);
  CHECK(glm::distance(glided.joints[0].shift, turned.rotation[0] * straight.joints[0].shift) < 1e-6);
  const auto asked = posed_from_rest(bars.armature, turned), shifted = posed_from_rest(bars.armature, glided.pose);
  CHECK(glm::distance(shifted[2].translation - asked[2].translation, glided.joints[0].shift) < 1e-6);
}

TEST_CASE("glide: the way to a pose has its share of the shift") {
  const Bars bars;
  const Pose pose = bars.glide(bars.bent(60)).pose;
  REQUIRE(pose.shift.size() == 3);
  CHECK(part_of_pose(pose, 1) == pose);
  CHECK(part_of_pose(pose, 0.5).shift[1] == 0.5 * pose.shift[1]);
  CHECK(pose_between(rest_pose(bars.armature), pose, 0.25).shift[1] == 0.25 * pose.shift[1]);
  CHECK(posed_from_rest(bars.armature, part_of_pose(pose, 0))[2].translation == glm::dvec3(0));
}

TEST_CASE("glide: is the same for any number of threads") {
  const Bars bars;
  std::vector<Pose> poses;
  for (int threads : {1, 2, 4}) {
    ThreadCount count(threads);
    poses.push_back(bars.glide(bars.bent(70)).pose);
  }
  CHECK(poses[0] == poses[1]);
  CHECK(poses[0] == poses[2]);
}
