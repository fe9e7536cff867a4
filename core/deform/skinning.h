// SPDX-License-Identifier: AGPL-3.0-or-later
// The one blend kernel: where a point goes that follows several bones. Spans of (bone, weight) of any length, double
// precision, lengths in the unit of the points.
//   linear blend      p + sum w (M p - p), so that rest is exact: bones that do not move leave p as it is, bit for bit
//   dual quaternion   the unit dual quaternions of the bones are added, each with the sign that agrees with the
//                     *running sum in influence order* (Blender's rule, which differs from aligning to the first or to
//                     the heaviest bone where rotations are more than 180 degrees apart), and the sum is normalized
//                     [Kavan, Collins, Zara & O'Sullivan 2008, Geometric skinning with approximate dual quaternion
//                     blending]
//   mixed             between the two, kQuaternionShare of the way from linear to dual quaternions: linear blending
//                     thins bent and twisted joints, dual quaternions make them bulge, and most of both cancels. Whole
//                     bodies that sit or raise their arms keep their volume best that way (assets/docs/guide.md has
//                     the figures).
// Dual quaternions hold no scale. A bone that stretches is split into a stretch along its own rest axes, then a rigid
// motion; the stretches are blended linearly and applied first.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/rigid_transform.h"

namespace limber {

// The number of a row of blend_rules() (blend_rule.h). A blend that nothing but the table knows needs no name here.
enum class Blend { Mixed, Linear, DualQuaternion };

constexpr double kQuaternionShare = 0.3;

// Returns the blend of a word of the table ("lbs", "dqs", "mix"), nothing for any other word.
std::optional<Blend> find_blend(std::string_view word);

struct BoneWeight {
  int bone;
  double weight;
};

// A bone's skinning transform, ready for both blends.
struct SkinTransform {
  std::array<double, 12> displacement{};     // of p: columns of M - 1, then the translation
  std::array<double, 8> dual_quaternion{1};  // unit; real then dual part, each w x y z
  std::array<double, 12> stretch{1, 0, 0, 0, 1, 0,
                                 0, 0, 1, 0, 0, 0};  // before the rigid part: columns, then translation
  bool has_stretch = false;
};

SkinTransform skin_transform(const RigidTransform& posed_from_rest);
std::vector<SkinTransform> skin_transforms(const std::vector<RigidTransform>& posed_from_rest);

// From a matrix that may scale and shear. `world_from_bone` is the bone's matrix at rest: a stretch is taken along its
// axes, and the bone's own y (head to tail) keeps its direction. Both affine, world_from_bone invertible.
SkinTransform skin_transform(const glm::dmat4& posed_from_rest, const glm::dmat4& world_from_bone);

// What rigid bones do together, as one that `blend` may blend further. Weights sum to one; no bone stretches.
SkinTransform blended_transform(Blend blend, std::span<const SkinTransform> bones,
                                std::span<const BoneWeight> influences);

// Weights need not sum to one (they are divided by their sum); a sum of zero leaves the point at rest.
glm::dvec3 blend_point(Blend blend, std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                       const glm::dvec3& rest_point);

// Many points, each with its own span: point i follows influences[offsets[i]] up to influences[offsets[i + 1]].
//   rest_points  #P     offsets  #P + 1     posed_points  #P, written; may be rest_points itself
void blend_points(Blend blend, std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                  std::span<const std::int64_t> offsets, std::span<const glm::dvec3> rest_points,
                  std::span<glm::dvec3> posed_points);

}  // namespace limber
