// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/measure/measure_overlay.h"

#include <algorithm>
#include <cmath>

#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/screen.h"
#include "editor/context/view_projection.h"
#include "editor/context/views.h"
#include "editor/measure/measure_view.h"
#include "editor/shown/compare_wipe.h"
#include "editor/ui/draw.h"
#include "editor/ui/widgets.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

constexpr float kLine = 2, kDot = 4;  // width of lines and size of points, pixels at scale 1
constexpr float kPad = 6, kRow = 16;  // padding and line height of a measurement's label, pixels at scale 1
constexpr double kArcShare = 0.35;    // radius of an angle's arc, as a fraction of the angle's shorter side
constexpr int kArcSteps = 24;
// A slice shows a measurement whose points are all within this distance of its plane, mm.
constexpr double kNearSlice = 5;
constexpr float kHiddenAlpha = 0.35f;  // opacity of the part of a girth's tape on the far side of the body

glm::dvec3 middle_of(const std::vector<glm::dvec3>& points) {
  glm::dvec3 sum(0);
  for (const glm::dvec3& point : points) sum += point;
  return sum / double(std::max<std::size_t>(points.size(), 1));
}

class MeasurePainter {
 public:
  MeasurePainter(Context& context, const ViewProjection& view, Colour colour)
      : context_(context),
        view_(view),
        colour_(colour) {}

  // Draws a line with a dark border, so that it is visible over light and dark tissue.
  void line(const glm::dvec3& from, const glm::dvec3& to, float alpha = 1) const {
    const auto a = view_.pixel_of(from), b = view_.pixel_of(to);
    if (!a || !b) return;
    ImDrawList* list = ImGui::GetWindowDrawList();
    const float width = context_.ui->look.px(kLine);
    list->AddLine(im(glm::vec2(*a)), im(glm::vec2(*b)), with_alpha(context_.ui->look.theme.view_plate, 0.6f * alpha),
                  width + context_.ui->look.px(2));
    list->AddLine(im(glm::vec2(*a)), im(glm::vec2(*b)), with_alpha(colour_, alpha), width);
  }
  void dot(const glm::dvec3& at) const {
    GizmoPainter(context_, view_).dot(at, colour_, context_.ui->look.theme.view_plate, kDot);
  }
  void tape(const std::vector<glm::dvec3>& corners) const {
    const glm::dvec3 middle = middle_of(corners);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
      const glm::dvec3 outward = (a + b) * 0.5 - middle;
      const bool is_hidden =
          view_.place.id == ViewId::Body && glm::dot(outward, view_.direction_to_eye((a + b) * 0.5)) < 0;
      line(a, b, is_hidden ? kHiddenAlpha : 1);
    }
  }
  void angle(const std::vector<glm::dvec3>& points) const {
    const glm::dvec3 a = points[0] - points[1], b = points[2] - points[1];
    const double radius = kArcShare * std::min(glm::length(a), glm::length(b));
    const double whole = glm::radians(measure(MeasureKind::Angle, points));
    if (radius <= 0 || whole <= 1e-6) return;
    const glm::dvec3 x = glm::normalize(a), across = b - glm::dot(b, x) * x;
    if (glm::length(across) < 1e-9) return;
    const glm::dvec3 y = glm::normalize(across);
    const auto at = [&](int i) {
      const double t = whole * i / kArcSteps;
      return points[1] + radius * (std::cos(t) * x + std::sin(t) * y);
    };
    for (int i = 0; i < kArcSteps; ++i) line(at(i), at(i + 1));
  }

 private:
  Context& context_;
  const ViewProjection& view_;
  Colour colour_;
};

// Returns true if a view shows a measurement. The 3D view always does; a slice does if all points are near its plane.
bool is_near(const ViewProjection& view, const std::vector<glm::dvec3>& points) {
  return view.place.id == ViewId::Body || std::all_of(points.begin(), points.end(), [&](const glm::dvec3& point) {
           return std::abs(glm::dot(point - view.slice.centre, view.towards_eye)) <= kNearSlice;
         });
}

// Returns the rectangle for a measurement's label near a pixel: the first of a few positions where it covers no other
// label.
Rect place_of_plate(const Look& look, const Rect& view, const glm::vec2& at, const glm::vec2& size,
                    const std::vector<Rect>& taken) {
  Rect first;
  for (int tries = 0; tries < 12; ++tries) {
    const float side = tries % 2 ? -1.0f : 1.0f, row = static_cast<float>(tries / 2) - (tries / 2 > 2 ? 6.0f : 0.0f);
    glm::vec2 low =
        at + glm::vec2(side > 0 ? look.px(10) : -look.px(10) - size.x, row * (size.y + look.px(3)) - size.y / 2);
    low = glm::clamp(low, view.low + look.px(4), glm::max(view.low, view.high - size - look.px(4)));
    const Rect rect{glm::round(low), glm::round(low) + size};
    if (tries == 0) first = rect;
    if (std::none_of(taken.begin(), taken.end(), [&](const Rect& other) { return other.overlaps(rect); })) return rect;
  }
  return first;
}

Colour colour_of_measure(const Ui& ui, bool is_chosen) { return is_chosen ? kGizmoActive : ui.look.theme.view_text; }

// Returns the point beside which a measurement's label lies: the right end of a girth's tape, the corner of an angle,
// otherwise the middle of the points.
glm::dvec3 place_beside(const ViewProjection& view, MeasureKind kind, const std::vector<glm::dvec3>& points) {
  if (kind == MeasureKind::Girth)
    return *std::max_element(points.begin(), points.end(), [&](const glm::dvec3& a, const glm::dvec3& b) {
      return glm::dot(a, view.right) < glm::dot(b, view.right);
    });
  return kind == MeasureKind::Angle && points.size() == 3 ? points[1] : middle_of(points);
}

}  // namespace

void draw_measure_lines(Context& context, const ViewProjection& view, MeasureKind kind,
                        const std::vector<glm::dvec3>& points, bool is_chosen) {
  const MeasurePainter painter(context, view, colour_of_measure(context.ui, is_chosen));
  if (kind == MeasureKind::Girth) return painter.tape(points);
  for (std::size_t i = 1; i < points.size(); ++i) painter.line(points[i - 1], points[i]);
  if (kind == MeasureKind::Angle && points.size() == 3) painter.angle(points);
  for (const glm::dvec3& point : points) painter.dot(point);
}

void draw_measure_label(Ui& ui, const ViewProjection& view, MeasureKind kind, const std::vector<glm::dvec3>& points,
                        const std::vector<std::string>& words, bool is_chosen, std::vector<Rect>& taken) {
  if (points.empty() || words.empty()) return;
  const Look& look = ui.look;
  const auto at = view.pixel_of(place_beside(view, kind, points));
  if (!at) return;
  float width = 0;
  for (std::size_t i = 0; i < words.size(); ++i)
    width = std::max(width, text_size(i ? look.fonts.small : look.fonts.semibold, words[i]).x);
  const glm::vec2 size{std::ceil(width) + look.px(2 * kPad), look.px(kRow * static_cast<float>(words.size()) + 6)};
  const Rect plate = place_of_plate(look, view.place.rect, glm::vec2(*at), size, taken);
  taken.push_back(plate);
  fill(plate, with_alpha(look.theme.view_plate, 0.85f), look.px(4));
  if (is_chosen) outline(plate, colour_of_measure(ui, true), look.px(4), look.line());
  for (std::size_t i = 0; i < words.size(); ++i) {
    const float y = plate.low.y + look.px(3 + kRow * static_cast<float>(i));
    put_text(ui, i ? look.fonts.small : look.fonts.semibold, i ? look.theme.view_text2 : look.theme.view_text,
             Rect{{plate.low.x + look.px(kPad), y}, {plate.high.x - look.px(kPad) + 1, y + look.px(kRow)}}, words[i]);
  }
}

namespace {
// Draws the measurements of one scene's body into a part of the view.
void draw_on_scene(Context& context, const ViewPlace& place, const render::Scene& scene, const Rect& part) {
  if (!scene.volume) return;
  const Measurements& all = *context.document().measurements;
  const ViewProjection view(context, place);
  const auto placed = placed_measurements(context, scene);
  std::vector<Rect> taken;
  ImGui::PushClipRect(im(part.low), im(part.high), true);
  // All lines are drawn before the first label, so that no line crosses another measurement's label.
  for (std::size_t i = 0; i < all.size(); ++i)
    if (is_near(view, placed[i]))
      draw_measure_lines(context, view, all[i].kind, placed[i], all[i].name == context.measures->chosen);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Measurement& one = all[i];
    if (!is_near(view, placed[i])) continue;
    const bool is_chosen = one.name == context.measures->chosen;
    const double now = measure(one.kind, placed[i]), rest = measure(one.kind, one.points);
    std::vector<std::string> words{text_of_measure(one.kind, now)};
    if (is_chosen) {
      words.push_back(one.name);
      if (std::abs(now - rest) >= 0.05) words.push_back("at rest " + text_of_measure(one.kind, rest));
    }
    const std::size_t before = taken.size();
    draw_measure_label(context.ui, view, one.kind, placed[i], words, is_chosen, taken);
    // While a modal tool is active, labels ignore clicks, so that the tool gets them.
    if (!context.interaction->modal && taken.size() > before && part.contains(taken.back()) &&
        press_area(context.ui, "measurement " + one.name, taken.back()).clicked)
      context.measures->chosen = one.name;
  }
  ImGui::PopClipRect();
}
}  // namespace

void draw_measurements_over(Context& context, const ViewPlace& place) {
  const auto& all = context.document().measurements;
  if (!all || all->empty() || !context.measures->shown) return;
  const bool is_wiped = context.views->other_scene && !context.screen->layout.by_sides;
  if (!is_wiped) return draw_on_scene(context, place, scene_of(context, place), place.rect);
  const float line = std::clamp(wipe_line(context.comparison, place.rect), place.rect.low.x, place.rect.high.x);
  {
    const PathScope side(context.ui, "A");
    draw_on_scene(context, place, *context.views->other_scene, {place.rect.low, {line, place.rect.high.y}});
  }
  draw_on_scene(context, place, context.views->scene, {{line, place.rect.low.y}, place.rect.high});
}

}  // namespace limber::editor
