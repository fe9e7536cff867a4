// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/key_curve.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/rig/joint_limits.h"

namespace limber {

namespace {

// Largest tangent of a clamped key, as a multiple of the smaller neighbouring velocity [Fritsch & Carlson].
constexpr double kSteepest = 3;

// The constant velocities from the key before to this key, and from this key to the one after, with the numbers of
// frames. At the first and last key the missing velocity is zero.
struct Ways {
  glm::dvec3 before{0}, after{0};
  double frames_before = 0, frames_after = 0;

  bool is_inner() const { return frames_before > 0 && frames_after > 0; }
  glm::dvec3 mean(const glm::dvec3& a, const glm::dvec3& b) const {
    return (frames_before * a + frames_after * b) / (frames_before + frames_after);
  }
};

glm::dvec3 way(const glm::dquat& from, const glm::dquat& to) { return turn_between(from, to); }
glm::dvec3 way(const glm::dvec3& from, const glm::dvec3& to) { return to - from; }

template <class Value>
Ways ways_at(const std::map<int, Value>& keys, typename std::map<int, Value>::const_iterator key) {
  Ways ways;
  if (key != keys.begin()) {
    const auto before = std::prev(key);
    ways.frames_before = static_cast<double>(key->first) - before->first;
    ways.before = way(before->second, key->second) / ways.frames_before;
  }
  if (const auto after = std::next(key); after != keys.end()) {
    ways.frames_after = static_cast<double>(after->first) - key->first;
    ways.after = way(key->second, after->second) / ways.frames_after;
  }
  return ways;
}

// Returns the clamped speed along one direction, where a and b are the speeds before and after the key.
double clamped(const Ways& ways, double a, double b) {
  if (a * b <= 0) return 0;
  const double mean = (ways.frames_before * a + ways.frames_after * b) / (ways.frames_before + ways.frames_after);
  const double most = kSteepest * std::min(std::abs(a), std::abs(b));
  return std::clamp(mean, -most, most);
}

glm::dvec3 clamped_tangent(const Ways& ways, const glm::dquat&) {
  const double a = glm::length(ways.before), b = glm::length(ways.after);
  if (a == 0 || b == 0) return glm::dvec3(0);
  const glm::dvec3 bisector = ways.before / a + ways.after / b;
  const double length = glm::length(bisector);
  if (length < 1e-9) return glm::dvec3(0);  // the bone turns exactly back to where it came from
  const glm::dvec3 through = bisector / length;
  return clamped(ways, glm::dot(ways.before, through), glm::dot(ways.after, through)) * through;
}

glm::dvec3 clamped_tangent(const Ways& ways, const glm::dvec3&) {
  glm::dvec3 tangent;
  for (int axis = 0; axis < 3; ++axis) tangent[axis] = clamped(ways, ways.before[axis], ways.after[axis]);
  return tangent;
}

template <class Value>
Tangents tangents(const std::map<int, Value>& keys, const KeyShape& shape,
                  typename std::map<int, Value>::const_iterator key) {
  switch (shape.handles) {
    case HandleKind::Aligned:
    case HandleKind::Free: return {shape.in, shape.out};
    case HandleKind::Flat: return {};
    case HandleKind::Automatic:
    case HandleKind::Clamped: break;
  }
  const Ways ways = ways_at(keys, key);
  if (!ways.is_inner()) return {};
  const glm::dvec3 tangent =
      shape.handles == HandleKind::Automatic ? ways.mean(ways.before, ways.after) : clamped_tangent(ways, key->second);
  return {tangent, tangent};
}

glm::dquat between(const glm::dquat& a, const glm::dquat& b, double share) {
  return glm::normalize(glm::slerp(a, b, share));
}
glm::dvec3 between(const glm::dvec3& a, const glm::dvec3& b, double share) { return glm::mix(a, b, share); }

glm::dquat bezier(const glm::dquat& a, const glm::dvec3& v0, const glm::dquat& b, const glm::dvec3& v1, double frames,
                  double share) {
  return bezier_rotation(a, v0, b, v1, frames, share);
}
glm::dvec3 bezier(const glm::dvec3& a, const glm::dvec3& v0, const glm::dvec3& b, const glm::dvec3& v1, double frames,
                  double share) {
  return bezier_shift(a, v0, b, v1, frames, share);
}

template <class Value>
Value value(const std::map<int, Value>& keys, const KeyShapes& shapes, double frame) {
  assert(!keys.empty());
  const auto after = std::find_if(keys.lower_bound(static_cast<int>(std::floor(frame))), keys.end(),
                                  [&](const auto& key) { return key.first >= frame; });
  if (after == keys.end()) return keys.rbegin()->second;
  if (after == keys.begin() || after->first == frame) return after->second;
  const auto before = std::prev(after);
  const KeyShape shape = shape_at(shapes, before->first);
  const double frames = static_cast<double>(after->first) - before->first, share = (frame - before->first) / frames;
  switch (shape.next) {
    case Interpolation::Constant: return before->second;
    case Interpolation::Linear: return between(before->second, after->second, share);
    case Interpolation::Bezier: break;
  }
  return bezier(before->second, tangents(keys, shape, before).out, after->second,
                tangents(keys, shape_at(shapes, after->first), after).in, frames, share);
}

}  // namespace

glm::dvec3 rotation_vector(const glm::dquat& q) {
  const glm::dvec3 v(q.x, q.y, q.z);
  const double sine = glm::length(v);
  if (sine == 0) return glm::dvec3(0);
  return 2 * std::atan2(sine, q.w) / sine * v;
}

glm::dvec3 turn_between(const glm::dquat& from, const glm::dquat& to) {
  const glm::dquat turn = to * glm::conjugate(from);
  return rotation_vector(turn.w < 0 ? -turn : turn);
}

glm::dquat bezier_rotation(const glm::dquat& q0, const glm::dvec3& v0, const glm::dquat& q1, const glm::dvec3& v1,
                           double frames, double share) {
  const glm::dvec3 w1 = v0 * (frames / 3), w3 = v1 * (frames / 3);
  glm::dquat turn = q1 * glm::conjugate(q0);
  if (turn.w < 0) turn = -turn;
  // Does not switch the quaternion to the sign with w >= 0, so that w2 changes continuously with the velocities, even
  // beyond half a turn.
  const glm::dvec3 w2 = rotation_vector(exponential(-w3) * turn * exponential(-w1));
  const double left = 1 - share, b1 = 1 - left * left * left, b2 = share * share * (3 - 2 * share),
               b3 = share * share * share;
  return glm::normalize(exponential(b3 * w3) * exponential(b2 * w2) * exponential(b1 * w1) * q0);
}

glm::dvec3 bezier_shift(const glm::dvec3& p0, const glm::dvec3& v0, const glm::dvec3& p1, const glm::dvec3& v1,
                        double frames, double share) {
  const double left = 1 - share, b1 = 1 - left * left * left, b2 = share * share * (3 - 2 * share),
               b3 = share * share * share;
  const glm::dvec3 w1 = v0 * (frames / 3), w3 = v1 * (frames / 3), w2 = p1 - p0 - w1 - w3;
  return p0 + b1 * w1 + b2 * w2 + b3 * w3;
}

Tangents tangents_at(const std::map<int, glm::dquat>& keys, const KeyShapes& shapes, int frame) {
  return tangents(keys, shape_at(shapes, frame), keys.find(frame));
}
Tangents tangents_at(const std::map<int, glm::dvec3>& keys, const KeyShapes& shapes, int frame) {
  return tangents(keys, shape_at(shapes, frame), keys.find(frame));
}

glm::dquat value_at(const std::map<int, glm::dquat>& keys, const KeyShapes& shapes, double frame) {
  return value(keys, shapes, frame);
}
glm::dvec3 value_at(const std::map<int, glm::dvec3>& keys, const KeyShapes& shapes, double frame) {
  return value(keys, shapes, frame);
}

}  // namespace limber
