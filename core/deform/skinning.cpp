// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/skinning.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/base/parallel.h"

namespace limber {

namespace {

// A stretch smaller than this is rounding of the matrix's source.
constexpr double kSmallestStretch = 1e-4;

glm::dvec3 transform(const std::array<double, 12>& m, const glm::dvec3& p) {
  return {m[0] * p.x + m[3] * p.y + m[6] * p.z + m[9], m[1] * p.x + m[4] * p.y + m[7] * p.z + m[10],
          m[2] * p.x + m[5] * p.y + m[8] * p.z + m[11]};
}

std::array<double, 12> columns(const glm::dmat3& linear, const glm::dvec3& offset) {
  return {linear[0].x, linear[0].y, linear[0].z, linear[1].x, linear[1].y, linear[1].z,
          linear[2].x, linear[2].y, linear[2].z, offset.x,    offset.y,    offset.z};
}

// [Kavan 2008, 3.2]: rotation q, then translation t  =  q + epsilon (0, t) q / 2
std::array<double, 8> dual_quaternion(const glm::dquat& q, const glm::dvec3& t) {
  return {q.w,
          q.x,
          q.y,
          q.z,
          -0.5 * (t.x * q.x + t.y * q.y + t.z * q.z),
          0.5 * (t.x * q.w + t.y * q.z - t.z * q.y),
          0.5 * (t.y * q.w + t.z * q.x - t.x * q.z),
          0.5 * (t.z * q.w + t.x * q.y - t.y * q.x)};
}

// The rotation nearest to m that keeps the direction of its y axis; the x axis stays in its plane with y.
glm::dmat3 rotation_along_y(const glm::dmat3& m) {
  const glm::dvec3 y = glm::normalize(m[1]);
  const glm::dvec3 z = glm::normalize(glm::cross(m[0], y));
  return {glm::cross(y, z), y, z};
}

glm::dvec3 blend_linear(std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                        const glm::dvec3& p) {
  std::array<double, 12> sum{};
  double total = 0;
  for (const auto& [bone, weight] : influences) {
    const auto& d = bones[bone].displacement;
    for (int i = 0; i < 12; ++i) sum[i] += weight * d[i];
    total += weight;
  }
  return total > 0 ? p + transform(sum, p) / total : p;
}

// The point under a dual quaternion of any length [Kavan 2008, 4.1: normalize, then transform, in one].
glm::dvec3 transform(const std::array<double, 8>& dq, const glm::dvec3& p) {
  const double w = dq[0];
  const glm::dvec3 v(dq[1], dq[2], dq[3]), d(dq[5], dq[6], dq[7]);
  const double squared_length = w * w + glm::dot(v, v);
  const glm::dvec3 move = glm::cross(v, glm::cross(v, p) + w * p) + w * d - dq[4] * v + glm::cross(v, d);
  return p + move * (2 / squared_length);
}

// On the side of what is there already: q and -q are the same rotation.
void add_aligned(std::array<double, 8>& sum, const std::array<double, 8>& q, double weight) {
  const double dot = sum[0] * q[0] + sum[1] * q[1] + sum[2] * q[2] + sum[3] * q[3];
  const double signed_weight = dot < 0 ? -weight : weight;
  for (int i = 0; i < 8; ++i) sum[i] += signed_weight * q[i];
}

template <bool Stretched>
glm::dvec3 blend_dual(std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                      const glm::dvec3& p) {
  std::array<double, 8> sum{};
  std::array<double, 12> stretch{};
  double total = 0;
  for (const auto& [bone, weight] : influences) {
    add_aligned(sum, bones[bone].dual_quaternion, weight);
    if constexpr (Stretched)
      for (int i = 0; i < 12; ++i) stretch[i] += weight * bones[bone].stretch[i];
    total += weight;
  }
  if (!(total > 0)) return p;
  if constexpr (Stretched) return transform(sum, transform(stretch, p) / total);
  return transform(sum, p);
}

template <bool Stretched>
glm::dvec3 blend_mixed(std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                       const glm::dvec3& p) {
  const glm::dvec3 linear = blend_linear(bones, influences, p) - p,
                   dual = blend_dual<Stretched>(bones, influences, p) - p;
  return p + ((1 - kQuaternionShare) * linear + kQuaternionShare * dual);
}

bool any_stretch(std::span<const SkinTransform> bones) {
  return std::any_of(bones.begin(), bones.end(), [](const SkinTransform& bone) { return bone.has_stretch; });
}

}  // namespace

Blend blend_named(std::string_view word) {
  return word == "mix" ? Blend::Mixed : word == "dqs" ? Blend::DualQuaternion : Blend::Linear;
}

SkinTransform skin_transform(const RigidTransform& posed_from_rest) {
  SkinTransform bone;
  const glm::dquat& q = posed_from_rest.rotation;
  bone.displacement = columns(glm::mat3_cast(q) - glm::dmat3(1), posed_from_rest.translation);
  bone.dual_quaternion = dual_quaternion(q, posed_from_rest.translation);
  return bone;
}

std::vector<SkinTransform> skin_transforms(const std::vector<RigidTransform>& posed_from_rest) {
  std::vector<SkinTransform> bones;
  bones.reserve(posed_from_rest.size());
  for (const RigidTransform& rigid : posed_from_rest) bones.push_back(skin_transform(rigid));
  return bones;
}

SkinTransform skin_transform(const glm::dmat4& posed_from_rest, const glm::dmat4& world_from_bone) {
  SkinTransform bone;
  const glm::dmat3 linear(posed_from_rest);
  glm::dmat4 rigid = posed_from_rest;

  const glm::dmat4 posed_from_bone = posed_from_rest * world_from_bone;
  const glm::dvec3 scale(glm::length(posed_from_bone[0]), glm::length(posed_from_bone[1]),
                         glm::length(posed_from_bone[2]));
  bone.has_stretch = !(glm::determinant(linear) > 0) || glm::length(scale - 1.0) > kSmallestStretch;
  if (bone.has_stretch) {
    glm::dmat4 turned(rotation_along_y(glm::dmat3(posed_from_bone)));
    turned[3] = posed_from_bone[3];
    const glm::dmat4 bone_from_world = glm::inverse(world_from_bone);
    const glm::dmat4 stretch = world_from_bone * glm::inverse(turned) * posed_from_bone * bone_from_world;
    bone.stretch = columns(glm::dmat3(stretch), glm::dvec3(stretch[3]));
    rigid = turned * bone_from_world;
  }
  bone.displacement = columns(linear - glm::dmat3(1), glm::dvec3(posed_from_rest[3]));
  bone.dual_quaternion = dual_quaternion(glm::normalize(glm::quat_cast(glm::dmat3(rigid))), glm::dvec3(rigid[3]));
  return bone;
}

SkinTransform blended_transform(Blend blend, std::span<const SkinTransform> bones,
                                std::span<const BoneWeight> influences) {
  SkinTransform sum;
  if (blend != Blend::Linear) sum.dual_quaternion = {};
  for (const auto& [bone, weight] : influences) {
    if (blend != Blend::Linear) add_aligned(sum.dual_quaternion, bones[bone].dual_quaternion, weight);
    if (blend != Blend::DualQuaternion)
      for (int i = 0; i < 12; ++i) sum.displacement[i] += weight * bones[bone].displacement[i];
  }
  return sum;
}

glm::dvec3 blend_point(Blend blend, std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                       const glm::dvec3& rest_point) {
  if (blend == Blend::Linear) return blend_linear(bones, influences, rest_point);
  for (const BoneWeight& influence : influences)
    if (bones[influence.bone].has_stretch)
      return blend == Blend::Mixed ? blend_mixed<true>(bones, influences, rest_point)
                                   : blend_dual<true>(bones, influences, rest_point);
  return blend == Blend::Mixed ? blend_mixed<false>(bones, influences, rest_point)
                               : blend_dual<false>(bones, influences, rest_point);
}

void blend_points(Blend blend, std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                  std::span<const std::int64_t> offsets, std::span<const glm::dvec3> rest_points,
                  std::span<glm::dvec3> posed_points) {
  assert(offsets.size() == rest_points.size() + 1 && posed_points.size() == rest_points.size());
  const bool stretched = any_stretch(bones);
  auto each = [&](const auto& kernel) {
    parallel_for(std::ssize(rest_points), 4096, [&](std::int64_t begin, std::int64_t end) {
      for (auto i = begin; i < end; ++i)
        posed_points[i] = kernel(bones, influences.subspan(offsets[i], offsets[i + 1] - offsets[i]), rest_points[i]);
    });
  };
  if (blend == Blend::Linear) each([](auto... a) { return blend_linear(a...); });
  else if (blend == Blend::Mixed && stretched) each([](auto... a) { return blend_mixed<true>(a...); });
  else if (blend == Blend::Mixed) each([](auto... a) { return blend_mixed<false>(a...); });
  else if (stretched) each([](auto... a) { return blend_dual<true>(a...); });
  else each([](auto... a) { return blend_dual<false>(a...); });
}

}  // namespace limber
