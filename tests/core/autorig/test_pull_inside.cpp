// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/pull_inside.h"

#include <cmath>

#include <doctest/doctest.h>

#include "core/autorig/rig_check.h"

namespace limber {

namespace {

const std::vector<double> kFree(6, 100);

// A rod, 9 mm thick, bent to a quarter of a circle with a radius of 40 mm around the y axis.
LabelVolume bent_tube() {
  LabelVolume volume;
  volume.grid.size = {60, 20, 30};
  volume.grid.spacing = {1, 1, 2};
  volume.grid.origin = {0, -10, 0};
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  for (int z = 0; z < 30; ++z)
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 60; ++x) volume.at({x, y, z}) = std::hypot(std::hypot(x, 2.0 * z) - 40, y - 10) < 4.5;
  return volume;
}

Armature along_arc(double radius, double from_degrees, double to_degrees, int bones) {
  const auto at = [&](int k) {
    const double angle = (from_degrees + (to_degrees - from_degrees) * k / bones) * 3.14159265358979323846 / 180;
    return radius * glm::dvec3(std::cos(angle), 0, std::sin(angle));
  };
  Armature rig;
  for (int b = 0; b < bones; ++b)
    rig.bones.push_back({.name = "B" + std::to_string(b), .parent = b - 1, .head = at(b), .tail = at(b + 1)});
  return rig;
}

}  // namespace

TEST_CASE(
    "draw inside: bones that leave the tissue come in whole, joints stay shared, and nothing moves more than it must") {
  const LabelVolume volume = bent_tube();
  // The joints lie in air, and so do the straight bones between them.
  const Armature rig = along_arc(45.5, 8, 82, 4);
  REQUIRE(check_rig(volume, rig).whole < 0.8);
  const Armature inside = drawn_inside(rig, volume, {}, kFree);
  CHECK(check_rig(volume, inside).whole == 1);
  CHECK(check_rig(volume, inside).outside.empty());
  for (int b = 0; b < 4; ++b) {
    CHECK(glm::distance(inside.bones[b].head, rig.bones[b].head) < 8);
    if (b > 0) CHECK(inside.bones[b].head == inside.bones[b - 1].tail);
  }
}

TEST_CASE("draw inside: a rig that lies in tissue is left alone, bit for bit, and so is what tissue is too far from") {
  const LabelVolume volume = bent_tube();
  const Armature within = along_arc(40, 10, 80, 6);
  CHECK(drawn_inside(within, volume, {}, kFree) == within);
  Armature away = within;
  for (Bone& bone : away.bones) bone.head.y += 200, bone.tail.y += 200;
  CHECK(drawn_inside(away, volume, {}, kFree) == away);
  away.bones[0].head.x = 1e300;
  CHECK_NOTHROW(drawn_inside(away, volume, {}, kFree));
}

TEST_CASE("draw inside: a joint moves no farther than it is free to") {
  const LabelVolume volume = bent_tube();
  const Armature rig = along_arc(45.5, 8, 82, 4);
  const Armature inside = drawn_inside(rig, volume, {}, {100, 100, 0.5, 100});
  CHECK(glm::distance(inside.bones[2].head, rig.bones[2].head) <= doctest::Approx(0.5));
  CHECK(check_rig(volume, inside).whole > check_rig(volume, rig).whole);
}

TEST_CASE("draw inside: what lies beyond a cut stays where it is") {
  const LabelVolume volume = bent_tube();
  const Armature rig = along_arc(45.5, 8, 82, 4);
  CHECK(drawn_inside(rig, volume, {{{0, 0, 1}, -10}}, kFree) == rig);
}

namespace {

// A block of 1 mm voxels with a slot through its middle.
LabelVolume slotted_block() {
  LabelVolume volume;
  volume.grid.size = {72, 70, 80};
  volume.voxels.assign(volume.grid.voxel_count(), 1);
  for (int z = 20; z < 60; ++z)
    for (int y = 4; y < 66; ++y)
      for (int x = 14; x < 58; ++x) volume.at({x, y, z}) = 0;
  return volume;
}

}  // namespace

TEST_CASE("draw inside: a hinge that stands alone slides along its axis, which turns its bone as before") {
  const LabelVolume volume = slotted_block();
  Armature rig;
  rig.bones = {{.name = "Jaw", .parent = -1, .head = {36, 2, 40}, .tail = {36, 68, 40}}};
  const glm::dvec3 as_ball = drawn_inside(rig, volume, {}, kFree).bones[0].head - rig.bones[0].head;
  CHECK(std::abs(as_ball.z) > 15);
  rig.bones[0].limits = {.type = JointLimits::Type::Hinge, .axis = {1, 0, 0}};
  const Armature inside = drawn_inside(rig, volume, {}, kFree);
  const glm::dvec3 as_hinge = inside.bones[0].head - rig.bones[0].head;
  CHECK(check_rig(volume, inside).whole == 1);
  CHECK(std::abs(as_hinge.x) > 15);
  CHECK(std::hypot(as_hinge.y, as_hinge.z) < 4);
}

TEST_CASE("draw inside: a bone that nothing hangs from ends where tissue does, if most of it is there") {
  LabelVolume volume;
  volume.grid.size = {20, 20, 70};
  volume.voxels.assign(volume.grid.voxel_count(), 1);
  Armature rig;
  rig.bones = {{.name = "Tip", .parent = -1, .head = {10, 10, 4}, .tail = {10, 10, 109}}};
  const Armature inside = drawn_inside(rig, volume, {}, {0});
  CHECK(inside.bones[0].head == rig.bones[0].head);
  CHECK(check_rig(volume, inside).whole == 1);
  rig.bones[0].tail.z = 240;
  CHECK(check_rig(volume, drawn_inside(rig, volume, {}, {0})).whole < 0.5);
}

}  // namespace limber
