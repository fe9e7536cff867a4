// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/joint_view.h"

#include <cmath>

#include <doctest/doctest.h>
#include <glm/gtc/quaternion.hpp>

using namespace limber;

namespace {

// Returns a joint at `head` whose upper bone starts at `parent`. The lower bone continues the upper one, turned by
// `degrees` about `axis`.
JointFigures bent(const glm::dvec3& parent, const glm::dvec3& head, const glm::dvec3& axis, double degrees) {
  const glm::dvec3 lower = glm::angleAxis(glm::radians(degrees), glm::normalize(axis)) * (head - parent);
  return {.bone = "Lower",
          .degrees = degrees,
          .axis = glm::normalize(axis),
          .head = head,
          .tail = head + lower,
          .parent_head = parent};
}

void check_frame(const PictureFrame& frame) {
  CHECK(glm::length(frame.right) == doctest::Approx(1));
  CHECK(glm::length(frame.up) == doctest::Approx(1));
  CHECK(std::abs(glm::dot(frame.right, frame.up)) < 1e-9);
}

}  // namespace

TEST_CASE("study pictures: a bent joint's fold faces the viewer, about whatever axis it turned and to either side") {
  const double cos35 = std::cos(glm::radians(35.0)), sin35 = std::sin(glm::radians(35.0));
  for (const glm::dvec3& axis : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(1, 2, 0.3),
                                 glm::dvec3(0, 0.02, 1), glm::dvec3(-3, 1, 2)})
    for (const double degrees : {10.0, 45.0, 90.0, 140.0}) {
      // The upper bone is perpendicular to the axis.
      const glm::dvec3 unit = glm::normalize(axis);
      const glm::dvec3 along = glm::normalize(glm::cross(unit, glm::dvec3(0.3, -0.2, 0.9)));
      const JointFigures joint = bent({5, 6, 7}, glm::dvec3(5, 6, 7) + 300.0 * along, axis, degrees);
      INFO("axis ", axis.x, " ", axis.y, " ", axis.z, ", ", degrees, " degrees");
      const glm::dvec3 fold = folding_side(joint);
      CHECK(std::abs(glm::dot(fold, unit)) < 1e-9);
      // The fold lies between the two bones, on the side towards which the joint turns.
      const glm::dvec3 upper = glm::normalize(joint.parent_head - joint.head),
                       lower = glm::normalize(joint.tail - joint.head);
      CHECK(glm::dot(fold, upper) == doctest::Approx(glm::dot(fold, lower)));
      CHECK(glm::dot(fold, glm::cross(unit, along)) > 0);
      const PictureFrame frame = folding_view(joint, joint.head);
      check_frame(frame);
      CHECK(frame.centre == joint.head);
      CHECK(glm::dot(frame.towards_eye(), fold) == doctest::Approx(sin35));
      CHECK(glm::dot(frame.towards_eye(), unit) == doctest::Approx(cos35));
      CHECK(frame.up.z >= -1e-9);
    }
}

TEST_CASE("study pictures: a straight joint is seen from the side towards which it turned") {
  JointFigures joint = bent({0, 0, 0}, {0, 0, -300}, {-1, 0, 0}, 30);
  joint.tail = {0, 0, -600};  // bent at rest; the pose straightens it
  CHECK(glm::distance(folding_side(joint), {0, -1, 0}) < 1e-9);
  joint.parent_head = joint.tail = joint.head;  // both bones have length 0
  check_frame(folding_view(joint, {0, 0, 0}));
}

TEST_CASE("study pictures: a limb is seen from the outer side of the body") {
  for (const double side : {-1.0, 1.0}) {
    const JointFigures joint = bent({side * 200, 0, 0}, {side * 200, 0, -300}, {-1, 0, 0}, 60);
    CHECK(side * folding_view(joint, {0, 0, -400}).towards_eye().x > 0.5);
  }
}
