// SPDX-License-Identifier: AGPL-3.0-or-later
// The one blend kernel. Takes (bone, weight) spans of any length, double precision.
//   linear blend      p + sum w (M p - p), so that rest is exact
//   dual quaternion   unit dual quaternions, sign aligned to the *running sum in influence order* (Blender's rule)
//                     [Kavan et al. 2008]; scale is blended linearly, before the dual quaternion
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/rigid_transform.h"

namespace limber {

enum class Blend { Linear, DualQuaternion };

struct BoneWeight {
  int bone;
  double weight;
};

// A bone's skinning transform, ready for both blends. `scale` is the stretch that precedes the rigid part
// (world = rigid * scale); the identity for every pose that Limber makes itself.
struct SkinTransform {
  RigidTransform rigid;
  glm::dmat3 linear{1};          // of the whole transform
  glm::dvec3 offset{0};
  glm::dquat real{1, 0, 0, 0};   // unit dual quaternion of the rigid part
  glm::dquat dual{0, 0, 0, 0};
  glm::dmat3 scale{1};
  bool has_scale = false;
};

std::vector<SkinTransform> skin_transforms(const std::vector<RigidTransform>& posed_from_rest);
SkinTransform skin_transform(const glm::dmat4& posed_from_rest);  // may scale and shear

// Weights need not sum to one (they are divided by their sum); no influence leaves the point at rest.
glm::dvec3 blend_point(Blend blend, const std::vector<SkinTransform>& bones, std::span<const BoneWeight> influences,
                       const glm::dvec3& rest_point);

}  // namespace limber
