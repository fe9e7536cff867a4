// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/chest_reach.h"

#include <cmath>

#include <doctest/doctest.h>

#include "core/binding/flesh_graph.h"
#include "core/binding/heat_diffusion.h"
#include "core/bones/bone_parts.h"
#include "core/seams/find_seams.h"
#include "tests/core/skin/small_body.h"

using namespace limber;
using namespace limber::test;

namespace {
constexpr double kVoxel = 8;  // edge of a voxel, mm

// Returns the distance of a point from the axis of a bone, mm.
double away(const Bone& bone, const glm::dvec3& at) { return distance_to_bone(bone, at); }

enum class Ribs { None, Cage };
enum class Arms { Apart, Beside };

// Returns half of the trunk's width, mm.
double half_width(Arms arms) { return arms == Arms::Apart ? 150 : 190; }

// A trunk of elliptic section, 300 or 380 mm x 200 mm, and two arms that hang away from it, or beside it so that they
// touch it. Rods of bone lie along the rig; a cage is a shell of bone within the chest. Lengths in mm, z upwards; the
// shoulders are at z = 560, the hips at z = 80.
SmallBody trunk_with_arms(Ribs ribs, Arms arms = Arms::Apart) {
  SmallBody body;
  body.tissues = muscle_and_bone();
  Armature& rig = body.armature;
  rig.bones = {bone_between("Hips", -1, {0, 0, 80}, {0, 0, 200}), bone_between("Spine", 0, {0, 0, 200}, {0, 0, 360}),
               bone_between("Chest", 1, {0, 0, 360}, {0, 0, 560}), bone_between("Neck", 2, {0, 0, 560}, {0, 0, 640})};
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "Left" : "Right";
    const glm::dvec3 hand = arms == Arms::Apart ? glm::dvec3(side * 340, 0, 360) : glm::dvec3(side * 260, 0, 280);
    rig.bones.push_back(bone_between((name + "Arm").c_str(), 2, {side * (half_width(arms) + 30), 0, 560}, hand));
    rig.bones.push_back(bone_between((name + "UpLeg").c_str(), 0, {side * 90, 0, 80}, {side * 100, 0, -40}));
  }
  const double half = half_width(arms);
  LabelVolume& volume = body.volume;
  volume.grid.size = {96, 32, 90};
  volume.grid.spacing = glm::dvec3(kVoxel);
  volume.grid.origin = {-380, -124, -40};
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  const AffineTransform world = world_from_voxel(volume.grid);
  for (int z = 0; z < volume.grid.size.z; ++z)
    for (int y = 0; y < volume.grid.size.y; ++y)
      for (int x = 0; x < volume.grid.size.x; ++x) {
        const glm::dvec3 at = world * glm::dvec3(x, y, z);
        const double section = std::hypot(at.x / half, at.y / 100);
        bool is_flesh = section < 1 && at.z > -30 && at.z < 590, is_bone = false;
        for (const Bone& bone : rig.bones) {
          const bool is_arm = bone.name.ends_with("Arm");
          is_flesh |= is_arm && away(bone, at) < 50;
          is_bone |= away(bone, at) < 12;
        }
        if (ribs == Ribs::Cage) is_bone |= is_flesh && std::abs(section - 0.75) < 0.06 && at.z > 370 && at.z < 550;
        if (is_flesh || is_bone) volume.at({x, y, z}) = is_bone ? kBone : kMuscle;
      }
  return body;
}

struct Held {
  explicit Held(const SmallBody& body)
      : tissue(body.volume),
        held_by(fixed_bone(body.volume, tissue, split_bones(body.volume, tissue, body.tissues, body.armature),
                           body.armature)) {}
  TissueVoxels tissue;
  ZeroedVector<std::uint16_t> held_by;
};

std::vector<BoneReach> reaches_in(const SmallBody& body) {
  const Held held(body);
  return reaches_in_body(body.volume.grid, held.tissue, body.armature, held.held_by);
}

// Returns the weight of the left arm at a point.
double weight_of_arm(const SmallBody& body, const glm::dvec3& at) {
  const TissueVoxels tissue(body.volume);
  const SkinWeights weights = diffuse_heat(body.volume, body.tissues, body.armature);
  const glm::ivec3 v(glm::round(voxel_from_world(body.volume.grid) * at));
  const int brick = tissue.brick_at(v);
  REQUIRE(tissue.index_of(v) >= 0);
  return weights.chunk(brick)[tissue.index_of(v) - tissue.bricks()[brick].first].of(4);
}
}  // namespace

TEST_CASE("chest: without ribs the arms count as further away, and the chest holds what it wins more firmly") {
  const SmallBody bare = trunk_with_arms(Ribs::None);
  REQUIRE(bare.armature.bones[4].name == "LeftArm");
  const std::vector<BoneReach> usual = reaches_of_bones(bare.armature), found = reaches_in(bare);
  for (std::size_t b = 0; b < found.size(); ++b) {
    CAPTURE(bare.armature.bones[b].name);
    // The spine (bone 1) counts as chest too: its middle lies just within the height of the ribs.
    const bool is_chest = b == 1 || b == 2, is_arm = bare.armature.bones[b].name.ends_with("Arm");
    for (const float way : {5.0f, 40.0f, 100.0f, 200.0f, 400.0f}) {
      CHECK((found[b](way) > usual[b](way)) == is_arm);
      if (!is_arm) CHECK(found[b](way) == usual[b](way));
      // The distance up to which a bone holds its own flesh becomes shorter for the chest, and does not change for
      // arms.
      const float held = found[b].held_from(found[b](way));
      if (is_chest) CHECK(held < usual[b](way));
      else CHECK(held == doctest::Approx(usual[b](way)));
    }
    CHECK(found[b](80) < found[b](81));
    CHECK(found[b](300) < found[b](301));
  }
  const std::vector<BoneReach> with_ribs = reaches_in(trunk_with_arms(Ribs::Cage));
  CHECK(with_ribs[2].held_from(with_ribs[2](100)) == usual[2](100));
}

TEST_CASE("chest: a helper bone of unknown name along the arm goes with the arm, and does not widen the chest") {
  const SmallBody bare = trunk_with_arms(Ribs::None);
  SmallBody helped = bare;
  helped.armature.bones.push_back(bone_between("zz1", 4, {260, 0, 460}, {340, 0, 360}));
  const std::vector<BoneReach> usual = reaches_in(bare), found = reaches_in(helped);
  CHECK(usual[2].cage_width > 100);
  CHECK(found[2].cage_width == usual[2].cage_width);
  CHECK(found.back().cage == BoneReach::Cage::Arm);
}

TEST_CASE("chest: a rig of an arm, or of unknown names, keeps its distances") {
  SmallBody body = trunk_with_arms(Ribs::None);
  for (Bone& bone : body.armature.bones) bone.name = "b" + bone.name.substr(bone.name.size() - 2) + "x";
  const std::vector<BoneReach> usual = reaches_of_bones(body.armature), found = reaches_in(body);
  for (std::size_t b = 0; b < found.size(); ++b) CHECK(found[b](100) == usual[b](100));
  const SmallBody bar = two_bone_bar();
  CHECK(reaches_in(bar)[0](100) == reaches_of_bones(bar.armature)[0](100));
}

TEST_CASE("chest: the flank of a body without ribs stays where it is when an arm is raised") {
  const SmallBody bare = trunk_with_arms(Ribs::None), whole = trunk_with_arms(Ribs::Cage);
  for (const glm::dvec3& at : {glm::dvec3(120, 0, 400), glm::dvec3(120, 0, 440), glm::dvec3(100, 40, 470)}) {
    CAPTURE(at.z);
    CHECK(weight_of_arm(bare, at) < 0.1);
    CHECK(weight_of_arm(whole, at) < 0.1);
  }
  CHECK(weight_of_arm(bare, {230, 0, 530}) > 0.9);
  CHECK(weight_of_arm(bare, {184, 30, 568}) > 0.5);
}

TEST_CASE("chest: a rib cage in one piece that touches no other bone follows the spine, not an arm beside it") {
  const SmallBody body = trunk_with_arms(Ribs::Cage);
  const Held held(body);
  const AffineTransform world = world_from_voxel(body.volume.grid);
  std::int64_t of_cage = 0, astray = 0;
  held.tissue.for_each([&](std::int64_t place, const glm::ivec3& v) {
    const glm::dvec3 at = world * glm::dvec3(v);
    if (body.volume.at(v) != kBone || std::hypot(at.x / 150, at.y / 100) < 0.6 || at.z < 370 || at.z > 545) return;
    if (std::abs(at.x) > 130) return;
    ++of_cage;
    astray += held.held_by[place] != 1 && held.held_by[place] != 2;
  });
  CHECK(of_cage > 1000);
  CHECK(astray == 0);
}

TEST_CASE("chest: no seam is cut through the flank of a body without ribs") {
  const SmallBody body = trunk_with_arms(Ribs::None, Arms::Beside);
  const TissueVoxels tissue(body.volume);
  const BoneParts parts = split_bones(body.volume, tissue, body.tissues, body.armature);
  const Seams seams = find_seams(body.volume, tissue, body.tissues, body.armature, parts, no_progress());
  const AffineTransform world = world_from_voxel(body.volume.grid);
  std::int64_t cut = 0;
  tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    const glm::dvec3 at = world * glm::dvec3(v);
    if (std::hypot(at.x / half_width(Arms::Beside), at.y / 100) > 0.8 || at.z < 200) return;
    for (int direction = 0; direction < 6; ++direction) cut += seams.is_cut_towards(v, direction);
  });
  CHECK(cut == 0);
  CHECK(seams.size() > 0);  // seams separate the arms from the trunk beside them
}
