// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/repair/volume_model.h"

#include <cmath>

#include <doctest/doctest.h>

#include "core/binding/heat_diffusion.h"
#include "core/bones/bone_parts.h"
#include "core/phantom/phantom.h"
#include "core/repair/capsule_shares.h"
#include "tests/support/bent_tube.h"

using namespace limber;
using namespace limber::test;

namespace {

struct Elbow {
  Phantom phantom = make_arm_phantom(8);
  TissueVoxels tissue{phantom.volume};
  WeightedBody body{phantom.volume, tissue, phantom.tissues, phantom.armature};
  SkinWeights heat = diffuse_heat(phantom.volume, tissue, phantom.tissues, phantom.armature,
                                  split_bones(phantom.volume, tissue, phantom.tissues, phantom.armature));
  JointMotion motion = joint_motion(phantom.armature, require_bone(phantom.armature, "Forearm"), TurnRange{-20, 120});
  JointField field{body, heat, motion, no_progress()};
};

}  // namespace

TEST_CASE("volume model: the gradient of what is minimized is that of finite differences, by every blend") {
  const Elbow elbow;
  for (const Blend blend : {Blend::DualQuaternion, Blend::Linear, Blend::Mixed}) {
    const VolumeModel model(elbow.body, elbow.field, elbow.motion, blend, no_progress());
    // With a narrow joint capsule, flesh folds and overlaps, so that every term of the total has a gradient.
    const std::vector<double> at =
        CapsuleShape(elbow.body, elbow.field, elbow.motion).shares({.flexor = 30, .extensor = 90});
    std::vector<double> gradient(at.size());
    const VolumeModel::Value value = model.evaluate(at, gradient);
    CHECK(value.folded > 0);
    CHECK(value.overlap > 0);
    // Tests two directions that change the values of all nodes by their positions, and the direction of the gradient.
    for (int direction = 0; direction < 3; ++direction) {
      std::vector<double> way(at.size());
      for (std::size_t n = 0; n < way.size(); ++n) {
        const glm::dvec3& p = elbow.field.node_position(static_cast<std::int64_t>(n));
        way[n] = direction == 0   ? std::sin(0.05 * p.x + 0.03 * p.z)
                 : direction == 1 ? std::cos(0.04 * p.y)
                                  : gradient[n];
        if (at[n] <= 0.01 || at[n] >= 0.99) way[n] = 0;
      }
      double expected = 0, length = 0;
      for (std::size_t n = 0; n < way.size(); ++n)
        expected += gradient[n] * way[n], length = std::max(length, std::abs(way[n]));
      const double h = 1e-3 / length;
      std::vector<double> ahead = at, behind = at;
      for (std::size_t n = 0; n < way.size(); ++n) ahead[n] += h * way[n], behind[n] -= h * way[n];
      const double slope = (model.evaluate(ahead, {}).total - model.evaluate(behind, {}).total) / (2 * h);
      CHECK(slope == doctest::Approx(expected).epsilon(0.02));
    }
  }
}

TEST_CASE("joint field: shares are the weights far from the joint and in bone, and node values around it") {
  const Elbow elbow;
  const std::vector<TissueKind> kinds = elbow.phantom.tissues.kinds();
  const std::vector<double> half(elbow.field.node_count(), 0.5);
  const AffineTransform world = world_from_voxel(elbow.phantom.volume.grid);
  std::int64_t free = 0, bone = 0;
  elbow.tissue.for_each([&](std::int64_t index, const glm::ivec3& voxel) {
    const double value = elbow.field.value(elbow.field.point(index, voxel), half), share = elbow.field.share(index),
                 mask = elbow.field.mask(index);
    CHECK(value == doctest::Approx((1 - mask) * share + mask * 0.5));
    const bool is_bone_voxel = is_bone(kinds[elbow.phantom.volume.at(voxel)]);
    if (is_bone_voxel) CHECK(mask == 0);
    if (glm::distance(world * glm::dvec3(voxel), elbow.motion.centre) > 400) CHECK(mask == 0);
    free += mask == 1;
    bone += is_bone_voxel;
  });
  CHECK(free > 100);
  CHECK(bone > 100);
}

TEST_CASE("joint gaps: two plates that stand at an angle touch when the turn closes the angle") {
  // Makes two plates of skin along rays from the joint, 60 degrees apart, 10 voxels deep along the axis.
  LabelVolume volume;
  volume.grid.size = {90, 90, 10};
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  const glm::dvec3 centre(20, 20, 5);
  for (int z = 0; z < 10; ++z)
    for (int y = 0; y < 90; ++y)
      for (int x = 0; x < 90; ++x) {
        const glm::dvec3 p = glm::dvec3(x, y, z) - centre;
        const double radius = std::hypot(p.x, p.y);
        if (radius > 60) continue;
        if (std::abs(p.y) < 3 && p.x > 0) volume.at({x, y, z}) = kSkin;
        if (std::abs(-p.x * std::sin(1.0472) + p.y * std::cos(1.0472)) < 3 && p.y > 0) volume.at({x, y, z}) = kSkin;
      }
  Armature rig;
  rig.bones = {{"still", -1, centre + glm::dvec3(60, 0, 0), centre},
               {"moving", 0, centre, centre + 60.0 * glm::dvec3(0.5, 0.866, 0)}};
  const TissueVoxels tissue(volume);
  const TissueTable tissues = tube_tissues();
  SkinWeights weights({"still", "moving"}, tissue);
  for (std::int64_t b = 0; b < std::ssize(tissue.bricks()); ++b) {
    SkinWeights::Influences chunk;
    tissue.for_each(b, b + 1, [&](std::int64_t, const glm::ivec3& v) {
      chunk.push_back(rigid_influence(v.y - centre.y > 0.577 * (v.x - centre.x)));
    });
    weights.set_chunk(b, chunk);
  }
  const WeightedBody body{volume, tissue, tissues, rig};
  // Turns the second plate towards the first: clockwise, seen from +z.
  JointMotion motion{.bone = 1, .centre = centre, .turns = {{{0, 0, -1}, 0.5}}, .moving = {1}};
  const JointField field(body, weights, motion, no_progress());
  const JointGaps gaps = joint_gaps(body, field, motion, {0, 0, -1});
  // Along a circle of radius r the gap is 60 degrees less half of each plate's thickness.
  int between = 0;
  for (const JointGap& gap : gaps.gaps) {
    if (gap.radius < 15 || gap.radius > 35 || gap.width > 2 * gap.radius) continue;
    const double expected = gap.radius * (1.0472 - 2 * std::asin(3.0 / gap.radius));
    // Samples are one step apart, and plates consist of whole voxels.
    CHECK(std::abs(gap.width - expected) <= gaps.step + 1);
    // Along the direction of the turn, the moving plate comes before the gap and the fixed plate after it.
    CHECK(field.value(gap.before, field.initial()) > 0.5);
    CHECK(field.value(gap.after, field.initial()) < 0.5);
    ++between;
  }
  CHECK(between > 5);
}
