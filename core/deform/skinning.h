// SPDX-License-Identifier: AGPL-3.0-or-later
// The blend kernel: computes the position of a point that follows several bones. Influences are spans of (bone, weight)
// of any length. All computations are in double precision, with lengths in the unit of the points.
//    linear blend     p + sum w (M p - p), with the weight w and the motion M of each bone. So the rest pose is exact:
//                     bones that do not move leave p unchanged, bit for bit.
//    dual quaternion  The unit dual quaternions of the bones are added, each with the sign that agrees with the
//                     running sum in influence order, and the sum is normalized. (The sign is Blender's rule; it
//                     differs from aligning to the first or heaviest bone if rotations are more than 180 degrees
//                     apart.) [Kavan, Collins, Zara & O'Sullivan 2008, Geometric skinning with approximate dual
//                     quaternion blending]
//    mixed            blends linearly and by dual quaternions, and averages the two positions: the dual quaternions'
//                     has the weight kQuaternionShare, the linear one has the remaining weight. Linear blending thins
//                     bent and twisted joints, dual quaternions make them bulge, and the two errors mostly cancel.
//                     Whole bodies that sit or raise their arms keep their volume best with this blend (figures in
//                     assets/docs/guide/blending.md).
// Dual quaternions contain no scale. The motion of a bone that stretches is split into a stretch along its own rest
// axes and a rigid motion; the stretches are blended linearly and applied first.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/rigid_transform.h"

namespace limber {

// Index of a row of blend_rules() (blend_rule.h). A blend that is only selected through that table needs no name here.
enum class Blend { Mixed, Linear, DualQuaternion };

constexpr double kQuaternionShare = 0.3;

// Returns the blend with the given word in the table ("lbs", "dqs", "mix"); nothing for any other word.
std::optional<Blend> find_blend(std::string_view word);

struct BoneWeight {
  int bone;
  double weight;
};

// A bone's skinning transform, in the representations that the blends need.
struct SkinTransform {
  std::array<double, 12> displacement{};     // M p - p as an affine map: columns of M - 1, then the translation
  std::array<double, 8> dual_quaternion{1};  // unit length; real part, then dual part, each as w x y z
  // The stretch that is applied before the rigid motion: columns of the matrix, then the translation.
  std::array<double, 12> stretch{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  bool has_stretch = false;
};

SkinTransform skin_transform(const RigidTransform& posed_from_rest);
std::vector<SkinTransform> skin_transforms(const std::vector<RigidTransform>& posed_from_rest);

// Makes a skinning transform from a matrix that may scale and shear. Both matrices must be affine, and world_from_bone
// invertible.
//   world_from_bone  the bone's matrix at rest. The stretch is along its axes, and the bone's own y axis (head to tail)
//                    keeps its direction
SkinTransform skin_transform(const glm::dmat4& posed_from_rest, const glm::dmat4& world_from_bone);

// Returns the blended motion of rigid bones as one transform, which can itself be blended again. Weights must sum to
// one; no bone may stretch.
SkinTransform blended_transform(Blend blend, std::span<const SkinTransform> bones,
                                std::span<const BoneWeight> influences);

// Returns the posed position of a point. Weights need not sum to one (they are divided by their sum). If they sum to
// zero, the point stays at rest.
glm::dvec3 blend_point(Blend blend, std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                       const glm::dvec3& rest_point);

// Poses many points. Point i has the influences from index offsets[i] up to, but not including, offsets[i + 1].
//   offsets       #P + 1, for #P points
//   rest_points   #P
//   posed_points  #P, out; may be the same memory as rest_points
void blend_points(Blend blend, std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                  std::span<const std::int64_t> offsets, std::span<const glm::dvec3> rest_points,
                  std::span<glm::dvec3> posed_points);

}  // namespace limber
