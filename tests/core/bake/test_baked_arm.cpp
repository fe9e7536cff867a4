// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses a baked elbow of a real arm at angles that were not baked, and counts voxels: tissues must keep their volume,
// and hardly any voxel may be claimed by two tissues.
#include "core/bake/bake_joint.h"

#include <cstdlib>
#include <map>
#include <memory>

#include <doctest/doctest.h>

#include "core/body/pose_body.h"
#include "core/rig_io/rig_io.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {

std::map<std::string, double> voxels_by_tissue(const LabelVolume& volume, const TissueTable& tissues) {
  std::map<std::string, double> voxels;
  for (const Label label : volume.voxels)
    if (const Tissue* tissue = tissues.find(label)) ++voxels[tissue->name];
  return voxels;
}

}  // namespace

TEST_CASE(
    "baked arm: between baked angles a real elbow keeps skin, fat and muscle, and hardly a voxel is claimed twice" *
    doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  const Body body = make_body(read_volume(shared_path("data/bender/man-arm-2mm.mha")), nullptr,
                              read_armature(shared_path("data/bender/man-arm-2mm-armature.vtk")), {}, {}, "arm");
  BoundBody bound = bind_body(body, Binding::Heat, {}, no_progress());
  const int bone = require_bone(body.rig, "Forearm");
  const JointBake bake =
      bake_joint(body, bound, bone, {.low = 0, .high = 70, .angles = 7, .quality = FemQuality::Draft}, no_progress());
  CHECK(bake.all_reached);
  for (const BakeError& error : bake.joint.between) CHECK(error.skin_mm < 1);

  PosingSettings settings{.method = "dqs"};
  const auto before = voxels_by_tissue(body.file.volume, body.tissues);
  for (const bool is_baked : {false, true})
    for (const double degrees : {25.0, 45.0, 65.0}) {
      CAPTURE(degrees);
      settings.resample.baked = is_baked ? BakedJoints{std::make_shared<const BakedJoint>(bake.joint)} : BakedJoints{};
      Pose pose = rest_pose(body.rig);
      flex(pose, body.rig, bone, degrees);
      pose_body(
          body, bound, {pose}, settings, {}, {},
          [&](BodyInPose& posed) {
            const auto after = voxels_by_tissue(posed.posed.volume, body.tissues);
            for (const char* name : {"skin", "fat", "muscle"}) {
              CAPTURE(name);
              REQUIRE(before.at(name) > 50'000);
              const double change = std::abs(after.at(name) / before.at(name) - 1);
              if (is_baked) CHECK(change < 0.01);
              else CHECK((degrees < 40 || change > 0.01));
            }
            if (is_baked) CHECK(posed.posed.report.overlap_voxels < 30);
            else CHECK((degrees < 40 || posed.posed.report.overlap_voxels > 100));
          },
          no_progress());
    }
}
