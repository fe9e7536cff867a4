// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/joint_axis_fit.h"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {
constexpr Label kBone = 1;

// Two bars of square section, 10 voxels high, that meet end to end at x = 20 with one voxel between them, and a rig
// whose hinge lies in the middle of their section, so that bending drives a corner of one bar into the other. The
// correct hinge lies at the edge towards which the bars bend.
struct Bars {
  LabelVolume volume{{.size = {41, 41, 12}, .spacing = {2, 2, 2}, .origin = {-40, -40, -10}},
                     ZeroedVector<Label>(41 * 41 * 12)};
  Armature armature;
  BoneParts parts;

  Bars() {
    for (int z = 2; z < 10; ++z)
      for (int y = 15; y < 26; ++y)
        for (int x = 2; x < 39; ++x)
          if (x != 20) volume.at({x, y, z}) = kBone;
    armature.bones.push_back({"fixed", -1, {-38, 0, 0}, {0, 0, 0}, 0, {}});
    armature.bones.push_back({"turning", 0, {0, 0, 0}, {30, 0, 0}, 0, {}});
    armature.bones.push_back({"tip", 1, {30, 0, 0}, {38, 0, 0}, 0, {}});
    armature.bones[1].limits = {.type = JointLimits::Type::Hinge, .axis = {0, 0, 1}, .minimum = 0, .maximum = 1};
    const TissueVoxels tissue(volume);
    parts.parts = {{0, 0, {}}, {1, 0, {}}, {2, 0, {}}};
    parts.part_of.resize(tissue.size());
    tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
      parts.part_of[place] = v.x < 20 ? 1 : v.x < 35 ? 2 : 3;
    });
  }

  // Counts the voxels of the fixed bar that the turning bar enters when the joint of `rig` turns by `degrees`, by
  // nearest voxels.
  int collisions(const Armature& rig, double degrees) const {
    const RigidTransform turn =
        rotation_about(rig.bones[1].head, glm::angleAxis(degrees * std::numbers::pi / 180, rig.bones[1].limits.axis));
    const AffineTransform world = world_from_voxel(volume.grid), voxel = voxel_from_world(volume.grid);
    int count = 0;
    for (int z = 0; z < 12; ++z)
      for (int y = 0; y < 41; ++y)
        for (int x = 0; x < 20; ++x) {
          if (volume.at({x, y, z}) != kBone) continue;
          const glm::ivec3 rest(glm::floor(voxel * (inverse(turn) * (world * glm::dvec3(x, y, z))) + 0.5));
          count += rest.x > 20 && volume.at_or_air(rest) == kBone;
        }
    return count;
  }
};
}  // namespace

TEST_CASE("fit joint: bars that bend into each other are hinged at their edge, and nothing collides any more") {
  const Bars bars;
  const TissueVoxels tissue(bars.volume);
  const FittedJoint fitted = fit_joint(bars.volume, tissue, bars.parts, bars.armature, 1, {.maximum_degrees = 60});
  CHECK(fitted.overlap_before > 100);
  CHECK(fitted.overlap_after == 0);
  CHECK(bars.collisions(bars.armature, 60) > 100);
  // Each colliding voxel is bone of either bar and is listed once. The overlap counts voxels at the worst angle only,
  // so the list is at least as long.
  int sides[2] = {0, 0};
  for (const glm::ivec3& v : fitted.colliding_before) {
    CHECK(bars.volume.at(v) == kBone);
    ++sides[v.x > 20];
  }
  CHECK(sides[0] >= fitted.overlap_before);
  CHECK(sides[1] > 100);
  for (std::size_t i = 1; i < fitted.colliding_before.size(); ++i)
    CHECK(fitted.colliding_before[i] != fitted.colliding_before[i - 1]);
  CHECK(fitted.colliding_after.empty());
  for (int degrees = 0; degrees <= 60; degrees += 3) CHECK(bars.collisions(fitted.armature, degrees) == 0);

  // The correct hinge lies at the edge, 11 mm from the middle of the section. A positive turn about z bends towards +y.
  const Bone& turning = fitted.armature.bones[1];
  CHECK(fitted.moved_mm < 13);
  CHECK(turning.head.y > 5);
  CHECK(glm::length(turning.head) == doctest::Approx(fitted.moved_mm));
  CHECK(std::abs(glm::dot(turning.head, glm::dvec3(0, 0, 1))) < 1e-9);
  CHECK(fitted.turned_degrees < 3);
  CHECK(turning.limits.type == JointLimits::Type::Hinge);
  CHECK(turning.limits.maximum == doctest::Approx(60 * std::numbers::pi / 180));
  CHECK(glm::length(turning.limits.axis) == doctest::Approx(1));
  CHECK(fitted.armature.bones[0].tail == turning.head);
  CHECK(fitted.armature.bones[2] == bars.armature.bones[2]);
}

TEST_CASE("fit joint: an axis about which nothing collides stays where it is") {
  Bars bars;
  bars.armature.bones[1].head = bars.armature.bones[0].tail = {0, 12, 0};
  const FittedJoint fitted =
      fit_joint(bars.volume, TissueVoxels(bars.volume), bars.parts, bars.armature, 1, {.maximum_degrees = 60});
  CHECK(fitted.overlap_before == 0);
  CHECK(fitted.moved_mm == 0);
  CHECK(fitted.turned_degrees == 0);
  CHECK(fitted.armature.bones[1].head == bars.armature.bones[1].head);
}

TEST_CASE("fit joint: is the same for any number of threads") {
  const Bars bars;
  const TissueVoxels tissue(bars.volume);
  std::vector<Armature> fitted;
  for (int threads : {1, 2, 4}) {
    ThreadCount count(threads);
    fitted.push_back(fit_joint(bars.volume, tissue, bars.parts, bars.armature, 1, {.maximum_degrees = 45}).armature);
  }
  CHECK(fitted[0] == fitted[1]);
  CHECK(fitted[0] == fitted[2]);
}

TEST_CASE("fit joint: fits the joints that a pose turns, for the turns it makes, and turns about the fitted axes") {
  const Bars bars;
  const TissueVoxels tissue(bars.volume);
  Pose pose = rest_pose(bars.armature);
  CHECK(fit_joints(bars.volume, tissue, bars.parts, bars.armature, pose).joints.empty());
  pose.rotation[1] = glm::angleAxis(-0.8, glm::dvec3(0, 0, 1));
  const FittedPose fitted = fit_joints(bars.volume, tissue, bars.parts, bars.armature, pose);
  REQUIRE(fitted.joints.size() == 1);
  CHECK(fitted.joints[0].bone == "turning");
  CHECK(fitted.joints[0].overlap_before > 50);
  CHECK(fitted.joints[0].overlap_after == 0);
  CHECK(fitted.warnings.empty());
  CHECK(fitted.armature.bones[1].head.y < -5);
  CHECK(glm::angle(fitted.pose.rotation[1]) == doctest::Approx(0.8));
  // The hinge axis keeps its direction, so that the sign of a flexion keeps its meaning.
  CHECK(fitted.armature.bones[1].limits.axis.z > 0.9);
  CHECK(glm::dot(glm::axis(fitted.pose.rotation[1]), fitted.armature.bones[1].limits.axis) == doctest::Approx(-1));
}

TEST_CASE("fit joint: refuses a range that is none and a joint without bone on both sides") {
  const Bars bars;
  const TissueVoxels tissue(bars.volume);
  CHECK_THROWS_AS(
      fit_joint(bars.volume, tissue, bars.parts, bars.armature, 1, {.minimum_degrees = 50, .maximum_degrees = 10}),
      Error);
  CHECK_THROWS_AS(fit_joint(bars.volume, tissue, bars.parts, bars.armature, 1, {.maximum_degrees = 270}), Error);
  BoneParts one_side = bars.parts;
  for (auto& part : one_side.parts) part.bone = 1;
  CHECK_THROWS_AS(fit_joint(bars.volume, tissue, one_side, bars.armature, 1), Error);
}

TEST_CASE("fit joint: a cancelled fit stops") {
  const Bars bars;
  Progress progress;
  progress.cancel();
  CHECK_THROWS_AS(fit_joint(bars.volume, TissueVoxels(bars.volume), bars.parts, bars.armature, 1, {}, progress),
                  Cancelled);
}

TEST_CASE("fit joint: the elbow of the Bender arm bends by 90 degrees without bone in bone" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  const VolumeFile file = read_volume(test::shared_path("data/bender/man-arm-2mm.mha"));
  const TissueTable tissues = merge_tissue_tables(file.tissues, nullptr);
  const Armature armature = read_armature(test::shared_path("data/bender/man-arm-2mm-armature.vtk"));
  const TissueVoxels tissue(file.volume);
  const BoneParts parts = split_bones(file.volume, tissue, tissues, armature);
  const FittedJoint fitted = fit_joint(file.volume, tissue, parts, armature, require_bone(armature, "Forearm"));
  CHECK(fitted.overlap_before > 900);
  CHECK(fitted.overlap_after == 0);
  CHECK(fitted.moved_mm < 16);
  CHECK(fitted.turned_degrees < 9);
}
