// SPDX-License-Identifier: AGPL-3.0-or-later
// Rings, arcs, arrows and read-outs over a view, of one size on the screen wherever they stand. Lengths are pixels at
// scale 1 unless they are said to be mm.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "editor/context/editor.h"
#include "editor/context/view_projection.h"

namespace limber::editor {

// A circle in the world: angles count from `from`, the right-handed way about `axis`.
struct Ring {
  glm::dvec3 centre{0}, axis{0, 0, 1}, from{1, 0, 0};  // unit
  double radius = 0;                                   // mm

  glm::dvec3 at(double angle) const {
    return centre + radius * (std::cos(angle) * from + std::sin(angle) * glm::cross(axis, from));
  }
  // Of the point that is under the pixel in the ring's plane.
  std::optional<double> angle_under(const ViewProjection& view, const glm::dvec2& pixel) const;
  // The half that faces the eye, and a little more, so that a ring seen from above is whole: where it begins, how far
  // it goes.
  std::pair<double, double> front(const ViewProjection& view) const;
};

// `pixels` large on the screen.
Ring ring_of(const ViewProjection& view, float scale, const glm::dvec3& centre, const glm::dvec3& axis, double pixels);

// Where a read-out stands: beside the point, at its other side near the view's edge, above or below it where neither
// has room; inside the view, whatever the point.
Rect place_of_read_out(const Look& look, const Rect& view, const glm::vec2& point);

class GizmoPainter {
 public:
  GizmoPainter(Editor& editor, const ViewProjection& view) : editor_(editor), view_(view) {}

  enum class Part { Whole, Front };
  void ring(const Ring& ring, Colour colour, float width, Part part) const;
  void arc(const Ring& ring, double from, double to, Colour colour, float width) const;
  void sector(const Ring& ring, double from, double by, Colour colour) const;
  void line(const glm::dvec3& from, const glm::dvec3& to, Colour colour, float width, bool dashed = false) const;
  void dot(const glm::dvec3& at, Colour fill, Colour edge, float radius) const;
  void circle(const glm::dvec3& at, Colour colour, float radius, float width) const;
  void square(const glm::dvec3& middle, const glm::dvec3& half_a, const glm::dvec3& half_b,
              Colour colour) const;  // halves in mm
  void diamond(const glm::dvec3& at, Colour colour, float size) const;
  void arrow(const glm::dvec3& from, const glm::dvec3& direction, Colour colour, float begin, float end, float width,
             bool box) const;
  void word(const glm::dvec3& at, const std::string& text, Colour colour) const;  // about the point
  // A bold line and a quiet one.
  void read_out(const glm::dvec3& at, const std::string& number, const std::string& axis, const std::string& below,
                Colour below_colour) const;

 private:
  void polyline(const std::vector<glm::dvec2>& pixels, Colour colour, float width) const;

  Editor& editor_;
  const ViewProjection& view_;
};

constexpr Colour kGizmoActive = 0xFF8AE0FF;  // FFE08A, what is dragged
// Views are dark in every theme, and so are these for it.
constexpr Colour kViewOk = 0xFF9AD15A, kViewWarn = 0xFF52BCF4, kViewError = 0xFF807AFF;  // 5AD19A, F4BC52, FF7A80
constexpr Colour kViewAccent = 0xFFFFBE8F;                                               // 8FBEFF

}  // namespace limber::editor
