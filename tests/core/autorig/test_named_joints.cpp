// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/named_joints.h"

#include <doctest/doctest.h>

#include "core/autorig/body_atlas.h"

namespace limber {

namespace {

constexpr double kHip = 400, kKnee = 200;  // height (z) of the joints, mm

TissueTable table_of(const std::vector<std::string>& names) {
  TissueTable table;
  for (const std::string& name : names) {
    const Label label = static_cast<Label>(table.tissues.size() + 1);
    table.tissues.push_back({.label = label, .file_value = double(label), .name = name, .kind = TissueKind::Bone});
  }
  return table;
}

// Two square shafts, 20 mm wide, one above the other with a gap of 4 mm at the knee, and a kneecap in front of the gap.
LabelVolume shafts() {
  LabelVolume volume;
  volume.grid.size = {40, 40, 110};
  volume.grid.spacing = {2, 2, 4};
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  for (int z = 0; z < 100; ++z)
    for (int y = 15; y < 25; ++y)
      for (int x = 15; x < 25; ++x) volume.at({x, y, z}) = z > 50 ? 1 : z < 50 ? 2 : 0;
  for (int z = 47; z < 54; ++z)
    for (int x = 17; x < 23; ++x) volume.at({x, 14, z}) = 3;
  return volume;
}

const BodyAtlas& leg() {
  static const BodyAtlas atlas = make_atlas(AtlasKind::Leg);
  return atlas;
}

}  // namespace

TEST_CASE("named joints: a knee lies between femur and tibia, and the kneecap does not draw it forward") {
  const Mannequin m(leg());
  for (const char* below : {"Left tibia", "Tibiae, fibulae and patellae, cortical"}) {
    LabelVolume volume = shafts();
    const bool joined = std::string(below).starts_with("Tibiae");
    if (joined)
      for (Label& voxel : volume.voxels) voxel = voxel == 3 ? 2 : voxel;
    const std::vector<NamedJoint> joints = named_joints(volume, table_of({"Left femur", below, "Left patella"}), m);
    REQUIRE(joints.size() == 1);
    CHECK(leg().rig.bones[joints[0].bone].name == "Shank");
    CHECK(joints[0].place.x == doctest::Approx(39).epsilon(0.03));
    CHECK(joints[0].place.y == doctest::Approx(39).epsilon(joined ? 0.15 : 0.03));
    CHECK(joints[0].place.z == doctest::Approx(kKnee).epsilon(0.03));
    CHECK(joints[0].error > 3);
    CHECK(joints[0].error < 20);
  }
}

TEST_CASE("named joints: labels that name no bone, and bones that do not meet, tell nothing") {
  const Mannequin m(leg());
  CHECK(named_joints(shafts(), table_of({"bone", "Muscle", "fat"}), m).empty());
  LabelVolume apart = shafts();
  for (int z = 30; z < 70; ++z)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) apart.at({x, y, z}) = 0;
  CHECK(named_joints(apart, table_of({"Left femur", "Left tibia", "Left patella"}), m).empty());
}

TEST_CASE("named joints: a body laid along them runs through them, as long as they lie apart") {
  Mannequin m(leg());
  const Armature& rig = leg().rig;
  const int thigh = *rig.find("Thigh"), shank = *rig.find("Shank"), foot = *rig.find("Foot");
  const std::vector<NamedJoint> joints = {
      {thigh, {10, 20, kHip}, 5}, {shank, {30, 20, 20}, 5}, {foot, {30, -280, 0}, 5}};
  lay_along(m, joints);
  for (const NamedJoint& joint : joints) CHECK(glm::distance(m.joint(joint.bone), joint.place) < 1e-6);
}

}  // namespace limber
