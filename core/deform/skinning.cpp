// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/skinning.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/base/parallel.h"
#include "core/deform/blend_kernels.h"
#include "core/deform/blend_rule.h"

namespace limber {

namespace {

// A stretch that differs from 1 by less than this counts as a rounding error of the matrix.
constexpr double kSmallestStretch = 1e-4;

std::array<double, 12> columns(const glm::dmat3& linear, const glm::dvec3& offset) {
  return {linear[0].x, linear[0].y, linear[0].z, linear[1].x, linear[1].y, linear[1].z,
          linear[2].x, linear[2].y, linear[2].z, offset.x,    offset.y,    offset.z};
}

// Returns the dual quaternion of the rotation q followed by the translation t: q + epsilon (0, t) q / 2 [Kavan 2008,
// 3.2].
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

// Returns a rotation matrix whose y axis has the direction of m's y axis, and whose x axis lies in the plane of m's x
// and y axes.
glm::dmat3 rotation_along_y(const glm::dmat3& m) {
  const glm::dvec3 y = glm::normalize(m[1]);
  const glm::dvec3 z = glm::normalize(glm::cross(m[0], y));
  return {glm::cross(y, z), y, z};
}

bool any_stretch(std::span<const SkinTransform> bones) {
  return std::any_of(bones.begin(), bones.end(), [](const SkinTransform& bone) { return bone.has_stretch; });
}

}  // namespace

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
  const BlendRule& rule = rule_of(blend);
  SkinTransform sum;
  if (rule.sums_dual_quaternions) sum.dual_quaternion = {};
  for (const auto& [bone, weight] : influences) {
    if (rule.sums_dual_quaternions) add_aligned(sum.dual_quaternion, bones[bone].dual_quaternion, weight);
    if (rule.sums_displacements)
      for (int i = 0; i < 12; ++i) sum.displacement[i] += weight * bones[bone].displacement[i];
  }
  return sum;
}

glm::dvec3 blend_point(Blend blend, std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                       const glm::dvec3& rest_point) {
  const BlendRule& rule = rule_of(blend);
  for (const BoneWeight& influence : influences)
    if (bones[influence.bone].has_stretch) return rule.stretched_point(bones, influences, rest_point);
  return rule.point(bones, influences, rest_point);
}

void blend_points(Blend blend, std::span<const SkinTransform> bones, std::span<const BoneWeight> influences,
                  std::span<const std::int64_t> offsets, std::span<const glm::dvec3> rest_points,
                  std::span<glm::dvec3> posed_points) {
  assert(offsets.size() == rest_points.size() + 1 && posed_points.size() == rest_points.size());
  const BlendRule& rule = rule_of(blend);
  const BlendRule::Point point = any_stretch(bones) ? rule.stretched_point : rule.point;
  parallel_for(std::ssize(rest_points), 4096, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = begin; i < end; ++i)
      posed_points[i] = point(bones, influences.subspan(offsets[i], offsets[i + 1] - offsets[i]), rest_points[i]);
  });
}

}  // namespace limber
