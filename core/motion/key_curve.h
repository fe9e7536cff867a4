// SPDX-License-Identifier: AGPL-3.0-or-later
// The curves that keys describe: where a bone, or the body, is between two keys, and how fast it passes through a key.
//
// Between two keys with rotations q0 and q1 a bone follows a cumulative cubic Bezier curve of quaternions [Kim, Kim &
// Shin, A general construction scheme for unit quaternion curves with simple high order derivatives, 1995]:
//   q(t) = exp(w3 B3(t)) exp(w2 B2(t)) exp(w1 B1(t)) q0,   t in [0, 1],
//   B1 = 1 - (1 - t)^3,   B2 = 3 t^2 - 2 t^3,   B3 = t^3,   w1 = v0 T/3,   w3 = v1 T/3,
// and w2 such that q(1) = q1. T is the number of frames from key to key. v0 and v1 are the exact angular velocities of
// the curve at the two keys: rotation vectors in the parent bone's frame, radians per frame. The exponentials therefore
// stand to the left of q0. The shape of the curve depends neither on the parent's frame nor on the bone's own frame. If
// all rotations are about one axis, the angle is the scalar Bezier curve with handles at thirds of the time. If both
// velocities are those of the slerp from q0 to q1, the curve is that slerp. The body's shift follows the cubic Bezier
// of its components.
//
// Let T0, T1 be the numbers of frames to the keys before and after, and s0, s1 the constant velocities from and to
// these keys. An automatic key has the tangent (T0 s0 + T1 s1) / (T0 + T1) [Catmull & Rom 1974]. A clamped key uses
// only the parts of s0 and s1 that have the same direction: for a bone, the parts along the bisector of s0 and s1; for
// the shift, the components of equal sign. Its tangent is at most three times the smaller part, so that the curve does
// not turn back between keys [Fritsch & Carlson 1980]. The first and the last key have the tangent zero.
#pragma once

#include "core/motion/keyframes.h"

namespace limber {

// When a project is read, larger values are cut to these limits: the body's shift, mm, and the components of a tangent,
// radians or mm per frame.
constexpr double kFarthestShift = 1e7, kSteepestTangent = 1e6;

// Returns the rotation vector of a unit quaternion, with an angle in [0, 2 pi). The vectors of q and -q have opposite
// directions and angles that add up to a full turn.
glm::dvec3 rotation_vector(const glm::dquat& q);
// Returns the rotation vector of the shortest rotation from one orientation to another, in the parent's frame.
glm::dvec3 turn_between(const glm::dquat& from, const glm::dquat& to);

// Returns the rotation on the Bezier curve from q0 to q1.
//   v0, v1  angular velocities at q0 and q1, radians per frame
//   frames  number of frames from q0 to q1
//   share   time since q0 as a share of `frames`, [0, 1]
glm::dquat bezier_rotation(const glm::dquat& q0, const glm::dvec3& v0, const glm::dquat& q1, const glm::dvec3& v1,
                           double frames, double share);
glm::dvec3 bezier_shift(const glm::dvec3& p0, const glm::dvec3& v0, const glm::dvec3& p1, const glm::dvec3& v1,
                        double frames, double share);

struct Tangents {
  glm::dvec3 in{0}, out{0};  // the speeds before and after a key, per frame
};
// Returns the tangents of the key at a frame. There must be a key at this frame.
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
