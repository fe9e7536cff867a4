// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/viewport/gizmo_draw.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "editor/context/view_projection.h"
#include "editor/ui/draw.h"

namespace limber::editor {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kRingSteps = 96;
constexpr double kBehind = 0.15;      // parts of a ring farther behind its centre are not drawn, fraction of its radius
constexpr float kUnderStroke = 1.6f;  // the dark line under each drawn line is wider by this, pixels at scale 1
constexpr Colour kUnder = 0x59000000;

ImVec2 im(const glm::dvec2& p) { return {static_cast<float>(p.x), static_cast<float>(p.y)}; }

ImDrawList& canvas() { return *ImGui::GetWindowDrawList(); }

}  // namespace

std::optional<double> Ring::angle_under(const ViewProjection& view, const glm::dvec2& pixel) const {
  const auto point = view.in_plane(pixel, centre, axis);
  if (!point) return std::nullopt;
  const glm::dvec3 off = *point - centre;
  return std::atan2(glm::dot(off, glm::cross(axis, from)), glm::dot(off, from));
}

std::pair<double, double> Ring::front(const ViewProjection& view) const {
  const glm::dvec3 to_eye = view.direction_to_eye(centre), nearest = to_eye - glm::dot(to_eye, axis) * axis;
  const double tilt = glm::length(nearest);  // sine of the angle between the axis and the line of sight
  if (tilt <= kBehind) return {0, 2 * kPi};
  const double half = std::acos(-kBehind / tilt);
  return {std::atan2(glm::dot(nearest, glm::cross(axis, from)), glm::dot(nearest, from)) - half, 2 * half};
}

Ring ring_of(const ViewProjection& view, float scale, const glm::dvec3& centre, const glm::dvec3& axis, double pixels) {
  const glm::dvec3 other = std::abs(axis.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  return {centre, axis, glm::normalize(glm::cross(other, axis)), pixels * scale * view.millimetres_per_pixel(centre)};
}

void GizmoPainter::polyline(const std::vector<glm::dvec2>& pixels, Colour colour, float width) const {
  if (pixels.size() < 2) return;
  std::vector<ImVec2> points;
  for (const glm::dvec2& pixel : pixels) points.push_back(im(pixel));
  const float scale = context_.ui->look.scale, alpha = static_cast<float>(colour >> 24) / 255;
  canvas().AddPolyline(points.data(), static_cast<int>(points.size()), with_alpha(kUnder, 0.35f * alpha), 0,
                       (width + kUnderStroke) * scale);
  canvas().AddPolyline(points.data(), static_cast<int>(points.size()), colour, 0, width * scale);
}

void GizmoPainter::ring(const Ring& ring, Colour colour, float width, Part part) const {
  const auto [begin, by] = part == Part::Front ? ring.front(view_) : std::pair(0.0, 2 * kPi);
  std::vector<glm::dvec2> run;
  for (int i = 0; i <= kRingSteps; ++i)
    if (const auto pixel = view_.pixel_of(ring.at(begin + by * i / kRingSteps))) run.push_back(*pixel);
  polyline(run, colour, width);
}

void GizmoPainter::arc(const Ring& ring, double from, double to, Colour colour, float width) const {
  std::vector<glm::dvec2> run;
  const int steps = std::max(2, static_cast<int>(std::ceil(std::abs(to - from) / (2 * kPi) * kRingSteps)));
  for (int i = 0; i <= steps; ++i)
    if (const auto pixel = view_.pixel_of(ring.at(from + (to - from) * i / steps))) run.push_back(*pixel);
  polyline(run, colour, width);
  // A short line across the ring marks each end of the arc. It is 12 pixels long on a ring with a radius of 96 pixels.
  const double half = ring.radius * 6 / 96;
  for (const double end : {from, to}) {
    Ring inner = ring, outer = ring;
    inner.radius -= half;
    outer.radius += half;
    const auto a = view_.pixel_of(inner.at(end)), b = view_.pixel_of(outer.at(end));
    if (a && b) polyline({*a, *b}, colour, width);
  }
}

void GizmoPainter::sector(const Ring& ring, double from, double by, Colour colour) const {
  const auto centre = view_.pixel_of(ring.centre);
  if (!centre || by == 0) return;
  by = std::clamp(by, -2 * kPi, 2 * kPi);
  const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(by) / (2 * kPi) * kRingSteps)));
  for (int i = 0; i < steps; ++i) {
    const auto a = view_.pixel_of(ring.at(from + by * i / steps)),
               b = view_.pixel_of(ring.at(from + by * (i + 1) / steps));
    if (!a || !b) continue;
    // Anti-aliasing is switched off, since soft edges of the triangles would be visible as lines between them.
    const ImDrawListFlags flags = canvas().Flags;
    canvas().Flags &= ~ImDrawListFlags_AntiAliasedFill;
    canvas().AddTriangleFilled(im(*centre), im(*a), im(*b), colour);
    canvas().Flags = flags;
  }
}

void GizmoPainter::line(const glm::dvec3& from, const glm::dvec3& to, Colour colour, float width, bool dashed) const {
  const auto a = view_.pixel_of(from), b = view_.pixel_of(to);
  if (!a || !b) return;
  if (!dashed) return polyline({*a, *b}, colour, width);
  const double scale = context_.ui->look.scale, length = glm::distance(*a, *b), dash = 4 * scale, gap = 3 * scale;
  if (length > 1e5) return;
  for (double t = 0; t < length; t += dash + gap)
    canvas().AddLine(im(glm::mix(*a, *b, t / length)), im(glm::mix(*a, *b, std::min(1.0, (t + dash) / length))), colour,
                     width * context_.ui->look.scale);
}

void GizmoPainter::dot(const glm::dvec3& at, Colour colour, Colour edge, float radius) const {
  const auto pixel = view_.pixel_of(at);
  if (!pixel) return;
  canvas().AddCircleFilled(im(*pixel), radius * context_.ui->look.scale, colour, 32);
  canvas().AddCircle(im(*pixel), radius * context_.ui->look.scale, edge, 32, 1.6f * context_.ui->look.scale);
}

void GizmoPainter::circle(const glm::dvec3& at, Colour colour, float radius, float width) const {
  const auto pixel = view_.pixel_of(at);
  if (!pixel) return;
  canvas().AddCircle(im(*pixel), radius * context_.ui->look.scale, with_alpha(kUnder, 0.35f), 48,
                     (width + kUnderStroke) * context_.ui->look.scale);
  canvas().AddCircle(im(*pixel), radius * context_.ui->look.scale, colour, 48, width * context_.ui->look.scale);
}

void GizmoPainter::square(const glm::dvec3& middle, const glm::dvec3& a, const glm::dvec3& b, Colour colour) const {
  const auto p = view_.pixel_of(middle - a - b), q = view_.pixel_of(middle + a - b), r = view_.pixel_of(middle + a + b),
             s = view_.pixel_of(middle - a + b);
  if (p && q && r && s) canvas().AddQuadFilled(im(*p), im(*q), im(*r), im(*s), colour);
}

void GizmoPainter::diamond(const glm::dvec3& at, Colour colour, float size) const {
  const auto pixel = view_.pixel_of(at);
  if (!pixel) return;
  const double half = size / 2 * context_.ui->look.scale;
  const glm::dvec2 p = *pixel;
  canvas().AddQuadFilled(im(p + glm::dvec2(0, -half)), im(p + glm::dvec2(half, 0)), im(p + glm::dvec2(0, half)),
                         im(p + glm::dvec2(-half, 0)), colour);
  canvas().AddQuad(im(p + glm::dvec2(0, -half)), im(p + glm::dvec2(half, 0)), im(p + glm::dvec2(0, half)),
                   im(p + glm::dvec2(-half, 0)), 0xFF1A1614, 1.1f * context_.ui->look.scale);
}

void GizmoPainter::arrow(const glm::dvec3& from, const glm::dvec3& direction, Colour colour, float begin, float end,
                         float width, bool box) const {
  const double unit = view_.millimetres_per_pixel(from) * context_.ui->look.scale;
  line(from + direction * (begin * unit), from + direction * (end * unit), colour, width);
  const auto foot = view_.pixel_of(from + direction * (end * unit)),
             tip = view_.pixel_of(from + direction * ((end + 12) * unit));
  if (!foot || !tip) return;
  const double scale = context_.ui->look.scale;
  if (box) return canvas().AddRectFilled(im(*foot - 4.0 * scale), im(*foot + 4.0 * scale), colour);
  const glm::dvec2 along = *tip - *foot;
  if (glm::length(along) < 0.5) return canvas().AddCircleFilled(im(*foot), static_cast<float>(5 * scale), colour, 24);
  const glm::dvec2 side = 5.0 * scale * glm::normalize(glm::dvec2(-along.y, along.x));
  canvas().AddTriangleFilled(im(*foot + side), im(*tip), im(*foot - side), colour);
}

Rect place_of_read_out(const Look& look, const Rect& view, const glm::vec2& point) {
  const glm::vec2 size{look.px(182), look.px(46)}, first = view.low + look.px(8),
                                                   last = glm::max(first, view.high - size - look.px(8));
  const float aside = look.px(128), away = look.px(40);
  glm::vec2 low = point + glm::vec2(aside, -look.px(66));
  if (low.x > last.x) low.x = point.x - aside - size.x;
  if (low.x < first.x)
    low = {point.x - size.x / 2, point.y - away - size.y < first.y ? point.y + away : point.y - away - size.y};
  low = glm::round(glm::clamp(low, first, last));
  return {low, low + size};
}

void GizmoPainter::word(const glm::dvec3& at, const std::string& text, Colour colour) const {
  const auto pixel = view_.pixel_of(at);
  if (!pixel) return;
  const glm::vec2 half = glm::vec2(text_size(context_.ui->look.fonts.small, text).x / 2 + context_.ui->look.px(3),
                                   context_.ui->look.px(8)),
                  middle = glm::round(glm::vec2(*pixel));
  fill({middle - half, middle + half}, with_alpha(context_.ui->look.theme.view_plate, 0.7f), context_.ui->look.px(3));
  put_text(context_.ui, context_.ui->look.fonts.small, colour, Rect{middle - half, middle + half}, text, Align::Centre);
}

void GizmoPainter::read_out(const glm::dvec3& at, const std::string& number, const std::string& axis,
                            const std::string& below, Colour below_colour) const {
  const auto centre = view_.pixel_of(at);
  if (!centre) return;
  const Look& look = context_.ui->look;
  const Rect place = place_of_read_out(look, view_.place.rect, glm::vec2(*centre));
  const glm::vec2 low = place.low;
  fill(place, with_alpha(look.theme.view_plate, 0.85f), look.px(5));
  const float right =
      put_text(context_.ui, look.fonts.mono, kGizmoActive, low + glm::vec2(look.px(10), look.px(5)), number);
  put_text(context_.ui, look.fonts.small, look.theme.view_text2, glm::vec2(right + look.px(10), low.y + look.px(6)),
           axis);
  put_text(context_.ui, look.fonts.small, below_colour,
           Rect{{low.x + look.px(10), low.y + look.px(23)}, place.high - glm::vec2(look.px(8), look.px(4))}, below);
}

}  // namespace limber::editor
