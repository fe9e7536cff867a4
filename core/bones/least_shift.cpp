// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/least_shift.h"

#include <algorithm>
#include <cmath>

namespace limber {

namespace {

using Points = std::vector<BoneDistance::SurfacePoint>;

// The overlap of two bones at one shift. `cost` is the sum of the squares of all depths beyond the allowed depth.
// `gradient` and `hessian` (Gauss-Newton) are derivatives of half of this sum. `depth` is the largest of these depths,
// mm.
struct Overlap {
  double cost = 0, depth = 0;
  glm::dvec3 gradient{0};
  glm::dmat3 hessian{0};
};

// The two bones of a joint, with the turning bone at one step of the joint's rotation.
class TurnedBones {
 public:
  //   reach  upper limit on the length of a shift, mm
  TurnedBones(const JointBones& bones, const Points& fixed, const Points& turning, const AffineTransform& motion,
              double reach)
      : bones_(bones),
        motion_(motion),
        back_{glm::transpose(motion.linear), -(glm::transpose(motion.linear) * motion.offset)} {
    for (const auto& point : turning)
      if (comes_near(bones.fixed, motion_ * point.place, point.mm, reach))
        turning_.push_back({motion_ * point.place, point.mm});
    for (const auto& point : fixed)
      if (comes_near(bones.turning, back_ * point.place, point.mm, reach)) fixed_.push_back(point);
  }

  Overlap overlap(const glm::dvec3& shift) const {
    Overlap sum;
    for (const auto& point : turning_)
      if (const auto there = bones_.fixed.below(point.place + shift, -point.mm))
        add(*there, there->slope, point.mm, sum);
    for (const auto& point : fixed_)
      if (const auto there = bones_.turning.below(back_ * (point.place - shift), -point.mm))
        add(*there, -(motion_.linear * there->slope), point.mm, sum);
    return sum;
  }

 private:
  // Returns true if a shift of at most `reach` mm may move a surface point of one bone into the other bone. The factor
  // 1.2 is needed because the interpolated distance may change by slightly more than the point moves.
  static bool comes_near(const BoneDistance& bone, const glm::dvec3& place, double mm, double reach) {
    const auto there = bone.at(place);
    return there ? there->mm + mm < 1.2 * reach : bone.outside(place) < reach;
  }

  // Returns the allowed depth of overlap, mm: half a voxel along the contact's normal, averaged over the voxel axes of
  // both bones.
  double allowed(const glm::dvec3& normal) const {
    return (glm::length(bones_.spacing * normal) + glm::length(bones_.spacing * (back_.linear * normal))) / 4;
  }

  void add(const BoneDistance::Sample& there, const glm::dvec3& slope, double mm, Overlap& sum) const {
    const double gap = there.mm + mm;
    if (gap >= 0) return;
    const double steepness = glm::length(slope);
    if (steepness < 1e-6) return;
    const double depth = -gap - allowed(slope / steepness);
    if (depth <= 0) return;
    sum.cost += depth * depth;
    sum.depth = std::max(sum.depth, depth);
    sum.gradient -= depth * slope;
    sum.hessian += glm::outerProduct(slope, slope);
  }

  const JointBones& bones_;
  AffineTransform motion_, back_;
  Points fixed_, turning_;  // surface points that can reach the other bone; turning_: after the motion
};

// Returns `shift` shortened so that both limits of `bound` hold.
glm::dvec3 within(glm::dvec3 shift, const ShiftBound& bound) {
  if (const double length = glm::length(shift); length > bound.most_mm) shift *= bound.most_mm / length;
  if (shift == glm::dvec3(0) || glm::length(bound.carried + shift) <= bound.whole_mm) return shift;
  // Solves |carried + s shift| = whole_mm for the factor s.
  const double a = glm::dot(shift, shift), b = glm::dot(bound.carried, shift);
  const double c = std::min(glm::dot(bound.carried, bound.carried) - bound.whole_mm * bound.whole_mm, 0.0);
  return shift * std::clamp((std::sqrt(b * b - a * c) - b) / a, 0.0, 1.0);
}

// Minimizes the squared length of the shift plus `weight` times the squares of the overlaps' depths, starting from
// `shift`.
glm::dvec3 descend(const TurnedBones& bones, glm::dvec3 shift, double weight, const ShiftBound& bound, int iterations) {
  Overlap at = bones.overlap(shift);
  double damping = 1e-3, cost = glm::dot(shift, shift) + weight * at.cost;
  for (int i = 0; i < iterations && damping < 1e6; ++i) {
    const glm::dvec3 gradient = shift + weight * at.gradient;
    glm::dmat3 hessian = glm::dmat3(1) + weight * at.hessian;
    for (int axis = 0; axis < 3; ++axis) hessian[axis][axis] *= 1 + damping;
    const glm::dvec3 next = within(shift - glm::inverse(hessian) * gradient, bound);
    const Overlap there = bones.overlap(next);
    const double next_cost = glm::dot(next, next) + weight * there.cost;
    if (next_cost >= cost) {
      damping *= 10;
      continue;
    }
    const bool settled = cost - next_cost < 1e-4 * cost;
    shift = next, at = there, cost = next_cost;
    damping = std::max(damping / 10, 1e-6);
    if (settled) break;
  }
  return shift;
}

// Returns `shift` shortened by bisection as far as the overlap stays at most `depth` mm deep.
glm::dvec3 shortened(const TurnedBones& bones, const glm::dvec3& shift, double depth) {
  double blocked = 0, free = 1;
  for (int i = 0; i < 8; ++i) {
    const double middle = (blocked + free) / 2;
    (bones.overlap(middle * shift).depth <= depth ? free : blocked) = middle;
  }
  return free * shift;
}

}  // namespace

LeastShift least_shift(const JointBones& bones, const std::vector<AffineTransform>& path, const ShiftBound& bound) {
  const Points fixed = bones.fixed.surface(), turning = bones.turning.surface();
  const double slack = glm::length(bones.spacing) / std::sqrt(3) / 20;
  const TurnedBones end(bones, fixed, turning, path.back(), bound.most_mm);
  LeastShift least;
  least.depth_before = least.depth_after = end.overlap(glm::dvec3(0)).depth;
  if (least.depth_before <= slack) return least;

  glm::dvec3 shift(0);
  for (std::size_t step = 0; step + 1 < path.size(); ++step)
    shift = descend(TurnedBones(bones, fixed, turning, path[step], bound.most_mm), shift, 1, bound, 4);
  for (const double weight : {1.0, 10.0, 100.0, 1000.0}) shift = descend(end, shift, weight, bound, 12);
  least.depth_after = end.overlap(shift).depth;
  least.free = least.depth_after <= slack;
  if (least.free) {
    shift = shortened(end, shift, slack);
    least.depth_after = end.overlap(shift).depth;
  }
  least.shift = shift;
  return least;
}

}  // namespace limber
