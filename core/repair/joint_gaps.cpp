// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/repair/joint_gaps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"

namespace limber {

namespace {

// Lower limit, mm, of the distance between circles and between samples on a circle, which is otherwise two voxels.
// Finer steps are not needed, as overlaps are as wide as layers of tissue.
constexpr double kLeastStep = 3;
// Upper limit on the angle of a gap, radians: wider gaps are not closed by any turn.
constexpr double kWidestTurn = std::numbers::pi;

// Cylindrical coordinates about the joint's axis: distance from the axis, angle about it, and height along it.
struct AxisFrame {
  glm::dvec3 centre, axis, across, along;

  AxisFrame(const glm::dvec3& centre, const glm::dvec3& axis) : centre(centre), axis(axis) {
    const glm::dvec3 other = std::abs(axis.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    across = glm::normalize(glm::cross(axis, other));
    along = glm::cross(axis, across);
  }
  glm::dvec3 point(double radius, double angle, double height) const {
    return centre + axis * height + radius * (std::cos(angle) * across + std::sin(angle) * along);
  }
};

// The extent of the tissue that the field may change: largest distance from the axis, and range of heights, mm.
struct Extent {
  double radius = 0, low = 0, high = 0;
};
Extent extent_of(const WeightedBody& body, const JointField& field, const AxisFrame& frame) {
  const AffineTransform world = world_from_voxel(body.volume.grid);
  Extent extent;
  body.tissue.for_each([&](std::int64_t index, const glm::ivec3& voxel) {
    if (field.mask(index) == 0) return;
    const glm::dvec3 p = world * glm::dvec3(voxel) - frame.centre;
    const double height = glm::dot(p, frame.axis);
    extent.radius = std::max(extent.radius, glm::length(p - frame.axis * height));
    extent.low = std::min(extent.low, height);
    extent.high = std::max(extent.high, height);
  });
  return extent;
}

// Walks along one circle about the joint's axis, and appends the gaps (runs of air between tissue) on it.
class CircleWalk {
 public:
  CircleWalk(const WeightedBody& body, const JointField& field, const std::vector<FleshClass>& classes)
      : body_(body),
        field_(field),
        classes_(classes),
        from_world_(voxel_from_world(body.volume.grid)) {}

  void add(const AxisFrame& frame, double radius, double height, JointGaps& out) {
    const int count = std::max(8, static_cast<int>(std::ceil(2 * std::numbers::pi * radius / out.step)));
    voxels_.clear();
    for (int i = 0; i < count; ++i) {
      const glm::ivec3 voxel(glm::round(from_world_ * frame.point(radius, 2 * std::numbers::pi * i / count, height)));
      voxels_.push_back(body_.volume.at_or_air(voxel) ? voxel : glm::ivec3(-1));
    }
    const double arc = 2 * std::numbers::pi * radius / count;
    for (int i = 0; i < count; ++i) {
      if (is_air(i) || !is_air(i + 1)) continue;
      int air = 1;
      while (air < count && is_air(i + 1 + air)) ++air;
      const double width = air * arc;
      if (air < count && width < kWidestTurn * radius) add_gap(i, i + 1 + air, radius, width, out);
    }
  }

 private:
  const glm::ivec3& voxel(int i) const { return voxels_[(i + std::ssize(voxels_)) % std::ssize(voxels_)]; }
  bool is_air(int i) const { return voxel(i).x < 0; }

  void add_gap(int before, int after, double radius, double width, JointGaps& out) {
    const std::int64_t first = body_.tissue.index_of(voxel(before)), last = body_.tissue.index_of(voxel(after));
    if (field_.mask(first) == 0 && field_.mask(last) == 0 && field_.share(first) == field_.share(last)) return;
    JointGap gap{field_.point(first, voxel(before)), field_.point(last, voxel(after)), static_cast<float>(radius),
                 static_cast<float>(width)};
    gap.first_before = list_inward(before, -1, out);
    gap.first_after = list_inward(after, 1, out);
    out.gaps.push_back(gap);
  }
  int list_inward(int from, int direction, JointGaps& out) const {
    const int first = static_cast<int>(std::ssize(out.inward));
    bool in_tissue = true;
    for (int d = 0; d < JointGaps::kDepth; ++d) {
      in_tissue = in_tissue && !is_air(from + d * direction);
      out.inward.push_back(in_tissue ? classes_[body_.volume.at(voxel(from + d * direction))] : FleshClass::Other);
    }
    return first;
  }

  const WeightedBody& body_;
  const JointField& field_;
  const std::vector<FleshClass>& classes_;
  AffineTransform from_world_;
  std::vector<glm::ivec3> voxels_;  // voxels along the circle; x = -1: air
};

}  // namespace

std::vector<FleshClass> flesh_classes(const TissueTable& tissues) {
  std::vector<FleshClass> classes(65536, FleshClass::Other);
  for (const Tissue& tissue : tissues.tissues) {
    if (tissue.kind == TissueKind::Skin) classes[tissue.label] = FleshClass::Skin;
    if (tissue.kind == TissueKind::Fat) classes[tissue.label] = FleshClass::Fat;
    if (tissue.kind == TissueKind::Muscle) classes[tissue.label] = FleshClass::Muscle;
  }
  return classes;
}

JointGaps joint_gaps(const WeightedBody& body, const JointField& field, const JointMotion& motion,
                     const glm::dvec3& axis) {
  const glm::dvec3& spacing = body.volume.grid.spacing;
  JointGaps gaps;
  gaps.step = std::max(2 * std::min({spacing.x, spacing.y, spacing.z}), kLeastStep);
  const std::vector<FleshClass> classes = flesh_classes(body.tissues);
  const AxisFrame frame(motion.centre, axis);
  const Extent extent = extent_of(body, field, frame);
  CircleWalk walk(body, field, classes);
  for (double height = extent.low; height <= extent.high; height += gaps.step)
    for (double radius = gaps.step / 2; radius <= extent.radius; radius += gaps.step)
      walk.add(frame, radius, height, gaps);
  return gaps;
}

}  // namespace limber
