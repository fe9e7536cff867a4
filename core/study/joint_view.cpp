// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/joint_view.h"

#include <algorithm>
#include <cmath>

namespace limber {

namespace {

// Angle between the joint's axis and the direction from which the fold is viewed, radians.
constexpr double kTurn = 35 * M_PI / 180;
constexpr double kStraight = 0.1;  // a joint is straight if the sum of its bones' unit directions is shorter than this
// A joint has an outer side if it is at least this far, along its axis, from the body's middle, mm.
constexpr double kOff_mm = 50;

glm::dvec3 across(const glm::dvec3& axis, const glm::dvec3& v) { return v - axis * glm::dot(v, axis); }

glm::dvec3 direction(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 1e-9 ? v / length : glm::dvec3(0);
}

// Returns the upward direction of a picture that is seen along `axis`: a unit vector perpendicular to the axis.
glm::dvec3 up_across(const glm::dvec3& axis, const JointFigures& joint) {
  glm::dvec3 up = across(axis, {0, 0, 1});
  if (glm::length(up) < 0.3) up = across(axis, joint.parent_head - joint.head);
  if (glm::length(up) < 1e-6) up = across(axis, {0, 1, 0});
  if (glm::length(up) < 1e-6) up = across(axis, {1, 0, 0});
  return glm::normalize(up);
}

}  // namespace

PictureFrame joint_plane(const JointFigures& joint) {
  PictureFrame frame{.centre = joint.head, .up = up_across(joint.axis, joint)};
  frame.right = glm::normalize(glm::cross(frame.up, joint.axis));
  frame.height_mm = std::clamp(
      0.9 * std::max(glm::distance(joint.head, joint.parent_head), glm::distance(joint.head, joint.tail)), 40.0, 500.0);
  return frame;
}

glm::dvec3 folding_side(const JointFigures& joint) {
  const glm::dvec3 towards_body = direction(across(joint.axis, joint.parent_head - joint.head)),
                   away = direction(across(joint.axis, joint.tail - joint.head));
  if (const glm::dvec3 inside = towards_body + away; glm::length(inside) > kStraight) return glm::normalize(inside);
  const glm::dvec3 turned = glm::cross(joint.axis, -towards_body);
  return glm::length(turned) > kStraight ? glm::normalize(turned) : joint_plane(joint).right;
}

PictureFrame folding_view(const JointFigures& joint, const glm::dvec3& body_centre) {
  const double along = glm::dot(joint.axis, joint.head - body_centre);
  const glm::dvec3 from = along < -kOff_mm ? -joint.axis : joint.axis;
  const glm::dvec3 eye = std::cos(kTurn) * from + std::sin(kTurn) * folding_side(joint);
  PictureFrame frame = joint_plane(joint);
  frame.up = up_across(eye, joint);
  frame.right = glm::normalize(glm::cross(frame.up, eye));
  return frame;
}

}  // namespace limber
