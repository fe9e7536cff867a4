// SPDX-License-Identifier: AGPL-3.0-or-later
// The curves that keys describe: where a bone, or the body, is between two keys, and how fast it passes through a key.
//
// Between two keys with rotations q0 and q1 a bone follows a cumulative cubic Bezier curve of quaternions [Kim, Kim &
// Shin, A general construction scheme for unit quaternion curves with simple high order derivatives, 1995]:
//   q(t) = exp(w3 B3(t)) exp(w2 B2(t)) exp(w1 B1(t)) q0,   t in [0, 1],
//   B1 = 1 - (1 - t)^3,   B2 = 3 t^2 - 2 t^3,   B3 = t^3,   w1 = v0 T/3,   w3 = v1 T/3,
// and w2 such that q(1) = q1. T is the number of frames from key to key; v0 and v1 are the angular velocities at the
// two keys, which the curve has exactly. They are rotation vectors in the parent bone's frame, radians per frame, so
// the factors stand on the left. The curve does not depend on the parent's frame nor on the bone's own frame. If all
// turns are about one axis, the angle is the scalar Bezier curve with handles at thirds of the time. If both velocities
// are those of the slerp from q0 to q1, the curve is that slerp. The body's shift follows the cubic Bezier of its
// components.
//
// With T0, T1 frames to the keys before and after, and s0, s1 the velocities on the straight ways to them, an automatic
// key has the tangent (T0 s0 + T1 s1) / (T0 + T1) [Catmull & Rom 1974]. A clamped key keeps of s0 and s1 only what goes
// the same way: for a bone, the parts along the bisector of s0 and s1; for the shift, the components of equal sign. The
// tangent is at most three times the smaller part, so that no part turns back between keys [Fritsch & Carlson 1980].
// The first and the last key have the tangent zero.
#pragma once

#include "core/motion/keyframes.h"

namespace limber {

// Bounds of what a project's file may hold: the body's shift in mm, and a tangent's components per frame.
constexpr double kFarthestShift = 1e7, kSteepestTangent = 1e6;

// Returns the rotation vector of a unit quaternion, with an angle in [0, 2 pi): q and -q differ by a turn.
glm::dvec3 rotation_vector(const glm::dquat& q);
// Returns the rotation vector of the shorter turn from one rotation to another, in the parent's frame.
glm::dvec3 turn_between(const glm::dquat& from, const glm::dquat& to);

//   v0, v1  angular velocities at the ends, radians per frame;  frames  from q0 to q1;  share  of the way, [0, 1]
glm::dquat bezier_rotation(const glm::dquat& q0, const glm::dvec3& v0, const glm::dquat& q1, const glm::dvec3& v1,
                           double frames, double share);
glm::dvec3 bezier_shift(const glm::dvec3& p0, const glm::dvec3& v0, const glm::dvec3& p1, const glm::dvec3& v1,
                        double frames, double share);

struct Tangents {
  glm::dvec3 in{0}, out{0};  // the speeds before and after a key, per frame
};
// Returns the tangents of the key at a frame, which exists.
Tangents tangents_at(const std::map<int, glm::dquat>& keys, const KeyShapes& shapes, int frame);
Tangents tangents_at(const std::map<int, glm::dvec3>& keys, const KeyShapes& shapes, int frame);

// Returns the value at a frame, which may lie between whole frames. Outside of the keys the first or last value holds.
// `keys` is not empty.
glm::dquat value_at(const std::map<int, glm::dquat>& keys, const KeyShapes& shapes, double frame);
glm::dvec3 value_at(const std::map<int, glm::dvec3>& keys, const KeyShapes& shapes, double frame);

// Returns the keys on which the value at a frame depends: the two keys around it and the next one on either side.
template <class Value>
std::map<int, Value> keys_around(const std::map<int, Value>& keys, int frame) {
  auto from = keys.upper_bound(frame), end = from;
  for (int i = 0; i < 2 && from != keys.begin(); ++i) --from;
  for (int i = 0; i < 2 && end != keys.end(); ++i) ++end;
  return {from, end};
}

}  // namespace limber
