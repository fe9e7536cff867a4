// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws rings, arcs, arrows and read-outs (numbers) of tools over a view. Their size on the screen is the same at any
// depth. Lengths are pixels at scale 1 unless marked as mm.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "editor/ui/rect.h"
#include "editor/ui/theme.h"

namespace limber::editor {

struct Context;
struct Look;
struct ViewProjection;

// A circle in the world. Angles on it are in radians, from the direction `from`, right-handed about `axis`.
struct Ring {
  glm::dvec3 centre{0}, axis{0, 0, 1}, from{1, 0, 0};  // centre: mm; axis, from: unit vectors at a right angle
  double radius = 0;                                   // radius of the circle, mm

  glm::dvec3 at(double angle) const {
    return centre + radius * (std::cos(angle) * from + std::sin(angle) * glm::cross(axis, from));
  }
  // Returns the angle on the ring, radians, of the point where the pixel's line of sight meets the ring's plane.
  // Returns no value if the line of sight misses the plane.
  std::optional<double> angle_under(const ViewProjection& view, const glm::dvec2& pixel) const;
  // Returns the part of the ring that faces the eye, as its first angle and its extent in radians. It is a little more
  // than half of the ring, or the whole ring if the line of sight is nearly parallel to its axis.
  std::pair<double, double> front(const ViewProjection& view) const;
};

// Returns a ring that has a radius of `pixels` on the screen, in pixels at scale 1.
Ring ring_of(const ViewProjection& view, float scale, const glm::dvec3& centre, const glm::dvec3& axis, double pixels);

// Returns the rectangle for a tool's read-out beside a point of a view. The rectangle lies at the right of the point.
// If there is no room at the right, it lies at the left, above or below. It is always inside the view.
Rect place_of_read_out(const Look& look, const Rect& view, const glm::vec2& point);

class GizmoPainter {
 public:
  GizmoPainter(Context& context, const ViewProjection& view) : context_(context), view_(view) {}

  enum class Part { Whole, Front };
  void ring(const Ring& ring, Colour colour, float width, Part part) const;
  void arc(const Ring& ring, double from, double to, Colour colour, float width) const;
  void sector(const Ring& ring, double from, double by, Colour colour) const;
  void line(const glm::dvec3& from, const glm::dvec3& to, Colour colour, float width, bool dashed = false) const;
  void dot(const glm::dvec3& at, Colour fill, Colour edge, float radius) const;
  void circle(const glm::dvec3& at, Colour colour, float radius, float width) const;
  // Draws a filled square. half_a, half_b: vectors from the middle to the middles of two sides, mm.
  void square(const glm::dvec3& middle, const glm::dvec3& half_a, const glm::dvec3& half_b, Colour colour) const;
  void diamond(const glm::dvec3& at, Colour colour, float size) const;
  void arrow(const glm::dvec3& from, const glm::dvec3& direction, Colour colour, float begin, float end, float width,
             bool box) const;
  // Draws a text that is centred on the point `at`.
  void word(const glm::dvec3& at, const std::string& text, Colour colour) const;
  // Draws a read-out of two lines of text: a bright number with the name of its axis, and the text `below`.
  void read_out(const glm::dvec3& at, const std::string& number, const std::string& axis, const std::string& below,
                Colour below_colour) const;

 private:
  void polyline(const std::vector<glm::dvec2>& pixels, Colour colour, float width) const;

  Context& context_;
  const ViewProjection& view_;
};

constexpr Colour kGizmoActive = 0xFF8AE0FF;  // RRGGBB: FFE08A; colour of the part of a gizmo that is being dragged
// Bright variants of the theme's colours, for drawing over views. Views have a dark background in every theme. As
// RRGGBB the next three are 5AD19A, F4BC52 and FF7A80; a Colour stores the bytes as AABBGGRR.
constexpr Colour kViewOk = 0xFF9AD15A, kViewWarn = 0xFF52BCF4, kViewError = 0xFF807AFF;
constexpr Colour kViewAccent = 0xFFFFBE8F;  // colour of accents over a view; RRGGBB: 8FBEFF

}  // namespace limber::editor
