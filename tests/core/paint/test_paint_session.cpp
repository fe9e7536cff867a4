// SPDX-License-Identifier: AGPL-3.0-or-later
// Paints an elbow by hand with two strokes of the joint capsule brush: one over the whole joint, one along its outer
// side.
//
// Two strokes are needed for this reason. A voxel with the weight w for the forearm turns by w times the angle about
// the joint's axis, so its volume changes by the factor 1 + angle (axis x r) . grad w. Summed over a tissue, the change
// is the angle times the integral of w (axis x r) . n over the tissue's surface: volume is lost inside the bend, where
// the surface moves into the tissue, and gained on the outer side. Heat weights blend equally widely on both sides, and
// then the gain is smaller than the loss. A wider blend along the outer side makes the gain larger. The blend inside
// the bend must not be too narrow, or cells invert.
#include <cmath>

#include <doctest/doctest.h>

#include "core/binding/heat_diffusion.h"
#include "core/bones/bone_parts.h"
#include "core/deform/lattice.h"
#include "core/deform/skinning.h"
#include "core/paint/stroke.h"
#include "core/report/metrics.h"
#include "core/resample/resample.h"
#include "core/rig/pose.h"
#include "core/rig_io/rig_io.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/shared_data.h"

using namespace limber;
using namespace limber::test;

namespace {

struct Arm {
  LabelVolume volume;
  TissueTable tissues;
  Armature rig;
  TissueVoxels tissue;
  int forearm;
};

SkinWeights painted(const Arm& arm, const SkinWeights& weights, double radius, double blend,
                    const std::vector<glm::dvec3>& way) {
  StrokeSettings settings{.bones = {arm.forearm}};
  settings.brush.kind = BrushKind::JointCapsule;
  settings.brush.distance = BrushDistance::Euclidean;
  settings.brush.radius = radius;
  settings.brush.blend_mm = blend;
  settings.brush.accumulate = true;
  Stroke stroke({arm.volume, arm.tissue, arm.tissues, arm.rig}, std::make_shared<const SkinWeights>(weights), settings);
  for (const glm::dvec3& point : way) stroke.to(point);
  return stroke.finish();
}

// Returns points along the outer side of the joint, from the upper arm to the forearm.
//   out           distance of the points from the bones, mm
//   above, below  distance from the joint at which the points begin on the upper arm and end on the forearm, mm
std::vector<glm::dvec3> outer_way(const Arm& arm, double out, double above, double below) {
  const Bone& fore = arm.rig.bones[arm.forearm];
  const glm::dvec3 joint = fore.head, up = glm::normalize(arm.rig.bones[fore.parent].head - joint),
                   down = glm::normalize(fore.tail - joint);
  const glm::dvec3 inner = glm::normalize(up + down);
  const auto outward = [&](const glm::dvec3& along) { return -glm::normalize(inner - along * glm::dot(inner, along)); };
  std::vector<glm::dvec3> way;
  for (double s = above; s > 0; s -= 20) way.push_back(joint + up * s + outward(up) * out);
  way.push_back(joint - inner * out);
  for (double s = 20; s < below; s += 20) way.push_back(joint + down * s + outward(down) * out);
  return way;
}

// Counts the cells in which one of their five tets is inverted.
std::int64_t inverted_cells(const Arm& arm, const SkinWeights& weights, const Pose& pose) {
  const PosedLattice lattice(arm.volume, arm.tissue, weights, posed_from_rest(arm.rig, pose), Blend::DualQuaternion,
                             glm::dvec3(1));
  constexpr int kTets[5][4] = {{0, 1, 2, 4}, {3, 2, 1, 7}, {5, 4, 7, 1}, {6, 7, 4, 2}, {1, 2, 4, 7}};
  std::int64_t inverted = 0;
  PosedLattice::Corners room;
  for (std::int64_t brick = 0; brick < std::ssize(arm.tissue.bricks()); ++brick) {
    const PosedLattice::Corners& corners = lattice.corners(brick, room);
    arm.tissue.for_each(brick, brick + 1, [&](std::int64_t, const glm::ivec3& voxel) {
      const glm::ivec3 in = voxel - arm.tissue.bricks()[brick].corner;
      const auto at = [&](int corner) {
        return glm::dvec3(
            corners[PosedLattice::place(in.x + (corner & 1), in.y + (corner >> 1 & 1), in.z + (corner >> 2))]);
      };
      for (const auto& t : kTets)
        if (glm::dot(glm::cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0])), at(t[3]) - at(t[0])) <= 0) {
          ++inverted;
          break;
        }
    });
  }
  return inverted;
}

struct Bent {
  double skin = 0, fat = 0, muscle = 0;  // change of volume, %
  std::int64_t inverted = 0;
  double sum() const { return std::abs(skin) + std::abs(fat) + std::abs(muscle); }
};

Bent bent(const Arm& arm, const SkinWeights& weights, double degrees) {
  Pose pose = rest_pose(arm.rig);
  flex(pose, arm.rig, arm.forearm, degrees);
  Bent bent;
  for (const TissueChange& change :
       compare(arm.volume, resample(arm.volume, arm.tissues, arm.rig, weights, pose, Blend::DualQuaternion).volume,
               arm.tissues)
           .tissues)
    for (const auto& [name, at] : {std::pair{"skin", &bent.skin}, {"fat", &bent.fat}, {"muscle", &bent.muscle}})
      if (change.name == name) *at = change.volume_change_percent;
  bent.inverted = inverted_cells(arm, weights, pose);
  return bent;
}

// Returns over what distance the forearm's weight rises from 1/20 to 19/20 along the bone near the joint, mm: the
// smallest over many lines beside the bone through soft tissue.
double blend_width(const Arm& arm, const SkinWeights& weights) {
  const Bone& fore = arm.rig.bones[arm.forearm];
  const glm::dvec3 up = glm::normalize(arm.rig.bones[fore.parent].head - fore.head),
                   down = glm::normalize(fore.tail - fore.head);
  const glm::dvec3 across = glm::normalize(glm::cross(up, down)), along = glm::normalize(down - up),
                   out = glm::cross(across, along);
  const AffineTransform from_world = voxel_from_world(arm.volume.grid);
  const std::vector<TissueKind> kinds = arm.tissues.kinds();
  std::vector<double> weight_at;
  for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick)
    for (const Influence& influence : weights.chunk(brick)) weight_at.push_back(influence.of(arm.forearm));
  double least = INFINITY;
  for (double angle = 0; angle < 6.28; angle += 0.26)
    for (const double beside : {15.0, 25.0, 35.0}) {
      double low = INFINITY, high = INFINITY;
      for (double s = -150; s <= 150; ++s) {
        const glm::ivec3 voxel(glm::round(
            from_world * (fore.head + along * s + beside * (std::cos(angle) * across + std::sin(angle) * out))));
        const Label label = arm.volume.at_or_air(voxel);
        if (label == 0 || is_bone(kinds[label])) continue;
        const double weight = weight_at[arm.tissue.index_of(voxel)];
        if (low == INFINITY && weight > 0.05) low = s;
        if (high == INFINITY && weight > 0.95) high = s;
      }
      if (high < INFINITY && low > -150) least = std::min(least, high - low);
    }
  return least;
}

}  // namespace

TEST_CASE(
    "paint session: two strokes at the elbow of the Bender arm keep a third more of its skin, fat and muscle than "
    "heat" *
    doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  VolumeFile file = read_volume(shared_path("data/bender/man-arm-2mm.mha"));
  Arm arm{.volume = std::move(file.volume),
          .tissues = merge_tissue_tables(file.tissues, nullptr),
          .rig = read_armature(shared_path("data/bender/man-arm-2mm-armature.vtk"))};
  arm.tissue = TissueVoxels(arm.volume);
  arm.forearm = require_bone(arm.rig, "Forearm");
  const SkinWeights heat = diffuse_heat(arm.volume, arm.tissue, arm.tissues, arm.rig,
                                        split_bones(arm.volume, arm.tissue, arm.tissues, arm.rig));
  CHECK(inverted_cells(arm, heat, rest_pose(arm.rig)) == 0);

  SkinWeights painted_arm = painted(arm, heat, 250, 90, {3, arm.rig.bones[arm.forearm].head});
  painted_arm = painted(arm, painted_arm, 80, 350, outer_way(arm, 60, 260, 220));
  const double width = blend_width(arm, painted_arm);
  MESSAGE("blend, at the narrowest, ", width, " mm");
  CHECK(width >= 20);
  for (const double degrees : {45.0, 60.0}) {
    const Bent by_heat = bent(arm, heat, degrees), by_hand = bent(arm, painted_arm, degrees);
    for (const Bent& b : {by_heat, by_hand})
      MESSAGE(degrees, " degrees: skin ", b.skin, ", fat ", b.fat, ", muscle ", b.muscle, " %, in all ", b.sum(), "; ",
              b.inverted, " cells turned over");
    CHECK(by_hand.sum() < 0.7 * by_heat.sum());
    CHECK(by_hand.inverted <= by_heat.inverted);
  }
}
