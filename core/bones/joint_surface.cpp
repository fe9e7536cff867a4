// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/joint_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber {

namespace {
// Squared distance from the joint's axis, in squared radii of the joint, beyond which the surface no longer curves.
constexpr double kRim = 1.3;
constexpr double kRound = 1.1;  // ratio of a joint's width to its depth below which the joint has no hinge direction
// If the ratio of a joint's width to its depth is at least this, the direction of the width is certainly the hinge.
constexpr double kClearlyWide = 1.25;

// Joint shapes measured on the bones of the BodyParts3D atlas at several voxel sizes, and rounded. The five numbers are
// the members of JointShape in their order. If a rig's joint is not in the middle of the joint's gap, JointShape::level
// includes this offset. The direction of a short rig bone, such as a hand's, is inexact, so the wrist's surface does
// not turn with the hand.
constexpr JointShape kKnuckle{0.1, -0.22, -0.2, 0.8, 2};        // the knuckle, a ball in a shallow cup
constexpr JointShape kFingerMiddle{0.07, -0.05, -0.4, 0.5, 2};  // a finger's middle joint, a roller across the finger
constexpr JointShape kFingerEnd{-0.1, 0.1, -0.45, 0.4, 2};
constexpr JointShape kThumbBase{-0.05, 0.3, 0, 0.5, 2};  // the thumb's base, a saddle joint
constexpr JointShape kThumbKnuckle{0.08, -0.17, -0.1, 0.8, 2};
constexpr JointShape kThumbEnd{-0.02, 0.2, -0.5, 0.5, 2};
constexpr JointShape kPalm{-0.08, 0.15, -0.05, 0.8, 1};  // the joint between a metacarpal and the wrist
constexpr JointShape kWrist{-0.1, 0.1, 0.2, 0, 1};       // the wrist, an egg in the hollow of the radius
constexpr JointShape kKnee{0, 0.1, 0.2, 0, 1};  // the knee, a shallow cup of the shank, with the kneecap in front
// The ankle, with the talus held between the ends of the shank's bones.
constexpr JointShape kAnkle{-0.1, 0.3, 0.1, -0.5, 2};

// The direction perpendicular to an axis in which points spread most, and the ratio of the points' spread in this
// direction to their spread in the third direction, perpendicular to axis and direction.
struct Width {
  glm::dvec3 direction;
  double ratio;
};
Width widest(const std::vector<glm::dvec3>& places, const glm::dvec3& axis) {
  const glm::dvec3 aside = std::abs(axis.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(axis, aside)), v = glm::cross(axis, u);
  double sum_u = 0, sum_v = 0, uu = 0, uv = 0, vv = 0;
  for (const glm::dvec3& p : places) {
    const double a = glm::dot(p, u), b = glm::dot(p, v);
    sum_u += a, sum_v += b, uu += a * a, uv += a * b, vv += b * b;
  }
  const double n = std::max<double>(1, double(places.size()));
  const double mean_u = sum_u / n, mean_v = sum_v / n;
  uu = uu / n - mean_u * mean_u, uv = uv / n - mean_u * mean_v, vv = vv / n - mean_v * mean_v;
  const double middle = (uu + vv) / 2, off = std::hypot((uu - vv) / 2, uv), turn = 0.5 * std::atan2(2 * uv, uu - vv);
  return {std::cos(turn) * u + std::sin(turn) * v, std::sqrt((middle + off) / std::max(1e-12, middle - off))};
}
}  // namespace

std::optional<JointShape> shape_of_joint(const std::optional<JointRole>& role) {
  if (!role) return std::nullopt;
  switch (role->part) {
    case BodyPart::Hand: return kWrist;
    case BodyPart::Shank: return kKnee;
    case BodyPart::Foot: return kAnkle;
    case BodyPart::Thumb: return role->index <= 1 ? kThumbBase : role->index == 2 ? kThumbKnuckle : kThumbEnd;
    case BodyPart::Index:
    case BodyPart::Middle:
    case BodyPart::Ring:
    case BodyPart::Little:
      return role->index == 0 ? kPalm : role->index == 1 ? kKnuckle : role->index == 2 ? kFingerMiddle : kFingerEnd;
    default: return std::nullopt;
  }
}

double JointSurface::height_of(const glm::dvec3& at) const {
  const glm::dvec3 from = at - joint;
  const double along = glm::dot(from, axis), side = glm::dot(from, hinge) / radius;
  const double aside = std::max(0.0, glm::dot(from, from) - along * along) / (radius * radius);
  const double across = std::max(0.0, aside - side * side);
  const double within = aside > kRim ? kRim / aside : 1;
  return along - radius * (shape.level + within * (shape.along_hinge * side * side + shape.across_hinge * across));
}

JointSurface flat_surface(const glm::dvec3& joint, const glm::dvec3& axis) {
  return {joint, axis, glm::dvec3(0), 1, {}};
}

JointSurface surface_of_joint(const JointShape& shape, const glm::dvec3& joint, const glm::dvec3& axis,
                              const std::vector<glm::dvec3>& bone, double volume, double half, double reach,
                              double smallest) {
  std::vector<glm::dvec3> slice;  // positions relative to the joint of the voxels in a slice through it, mm
  for (const glm::dvec3& at : bone) {
    const glm::dvec3 from = at - joint;
    if (std::abs(glm::dot(from, axis)) < half && glm::length(from) < reach) slice.push_back(from);
  }
  JointSurface surface{joint, axis, glm::dvec3(0), 0, shape};
  surface.radius = std::max(smallest, std::sqrt(double(slice.size()) * volume / (2 * half) / std::numbers::pi));
  const Width width = widest(slice, axis);
  surface.hinge = width.direction;
  // If the joint is about as deep as wide, its hinge direction is not known, and the surface gets the same curvature in
  // all directions.
  const double sure = std::clamp((width.ratio - kRound) / (kClearlyWide - kRound), 0.0, 1.0);
  const double mean = (shape.along_hinge + shape.across_hinge) / 2;
  surface.shape.along_hinge = mean + sure * (shape.along_hinge - mean);
  surface.shape.across_hinge = mean + sure * (shape.across_hinge - mean);
  return surface;
}

}  // namespace limber
