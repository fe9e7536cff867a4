// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/viewport/angle_drag.h"

#include <cmath>
#include <numbers>

namespace limber::editor {

AngleDrag::AngleDrag(const ViewProjection& view, float scale, const glm::dvec3& pivot, bool on_ring)
    : view_(view),
      scale_(scale),
      on_ring_(on_ring) {
  ring_.centre = pivot;
  centre_ = view.pixel_of(pivot).value_or(glm::dvec2(view.place.rect.centre()));
}

void AngleDrag::about(const glm::dvec3& axis, const glm::dvec2& start, const glm::dvec2& pointer) {
  ring_ = ring_of(view_, scale_, ring_.centre, axis, kRing);
  start_ = ring_.angle_under(view_, start).value_or(0);
  last_ = ring_.angle_under(view_, pointer);
}

void AngleDrag::follow(const glm::dvec2& from, const glm::dvec2& to) {
  const glm::dvec2 a = from - centre_, b = to - centre_;
  // An angle is positive if it is counter-clockwise on the screen. The window's y axis points down, so the sign of this
  // cross product is the opposite of the usual one.
  swept_seen_ += std::atan2(a.y * b.x - a.x * b.y, glm::dot(a, b));
  if (const auto angle = ring_.angle_under(view_, to)) {
    if (last_) swept_ring_ += std::remainder(*angle - *last_, 2 * std::numbers::pi);
    last_ = angle;
  }
}

double AngleDrag::degrees() const {
  // About an axis that points away from the eye, a counter-clockwise sweep on the screen is a negative angle.
  const double facing = glm::dot(ring_.axis, view_.towards_eye) < 0 ? -1 : 1;
  return glm::degrees(on_ring_ ? swept_ring_ : swept_seen_ * facing);
}

void AngleDrag::draw(const GizmoPainter& painter, const Theme& theme, double degrees) const {
  const double by = glm::radians(degrees);
  painter.sector(ring_, start_, by, with_alpha(theme.select, 0.22f));
  painter.ring(ring_, kGizmoActive, 3.5f, GizmoPainter::Part::Whole);
  painter.line(ring_.centre, ring_.at(start_), kGizmoActive, 1, true);
  painter.line(ring_.centre, ring_.at(start_ + by), kGizmoActive, 1.6f);
  painter.dot(ring_.at(start_ + by), kGizmoActive, 0xFF1A1614, 6);
}

}  // namespace limber::editor
