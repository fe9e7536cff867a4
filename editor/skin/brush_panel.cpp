// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the Brush section of the Skin workspace's sidebar: falloff, spacing, reach and normalization.
#include <algorithm>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/views.h"
#include "editor/labels/label_brush.h"
#include "editor/seams/seam_view.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/brush_presets.h"
#include "editor/skin/paint_mode.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/section.h"

namespace limber::editor {

namespace {

constexpr float kCurveHeight = 56;
constexpr int kCurvePoints = 48;
constexpr int kMostPoints = 16;     // a click adds no point to a custom falloff curve that has this many
constexpr double kPointGap = 0.02;  // points of the curve keep at least this distance in x, as a fraction of the radius
constexpr float kPointReach = 8;

// Draws the brush's falloff from its centre (left) to its rim (right).
void draw_curve(const Ui& ui, const Rect& rect, const Falloff& falloff) {
  const Look& look = ui.look;
  fill(rect, look.theme.field, look.px(4));
  const Rect inside{rect.low + look.px(6), rect.high - look.px(6)};
  std::vector<ImVec2> line;
  for (int i = 0; i <= kCurvePoints; ++i) {
    const float share = float(i) / kCurvePoints;
    line.push_back(im(glm::vec2(glm::mix(inside.low.x, inside.high.x, share),
                                glm::mix(inside.high.y, inside.low.y, std::clamp(falloff(share), 0.0f, 1.0f)))));
  }
  ImGui::GetWindowDrawList()->AddPolyline(line.data(), static_cast<int>(line.size()), look.theme.accent_text, 0,
                                          1.5f * look.scale);
}

// Edits the points of a custom falloff curve: a drag moves a point, a click beside the points adds one, a right click
// on a point removes it.
void edit_curve(Context& context, const Rect& rect, Painting& painting) {
  const Look& look = context.ui->look;
  const Rect inside{rect.low + look.px(6), rect.high - look.px(6)};
  std::vector<glm::dvec2>& points = painting.falloff_curve;
  const auto pixel_of = [&](const glm::dvec2& point) {
    return glm::vec2(glm::mix(inside.low.x, inside.high.x, float(point.x)),
                     glm::mix(inside.high.y, inside.low.y, float(point.y)));
  };
  const glm::dvec2 at = glm::clamp(glm::dvec2((context.ui->input.pointer.x - inside.low.x) / inside.width(),
                                              (inside.high.y - context.ui->input.pointer.y) / inside.height()),
                                   0.0, 1.0);
  const Pressed pressed = press_area(context.ui, "curve", rect);
  int nearest = 0;
  for (int i = 1; i < std::ssize(points); ++i)
    if (glm::distance(pixel_of(points[i]), context.ui->input.pointer) <
        glm::distance(pixel_of(points[nearest]), context.ui->input.pointer))
      nearest = i;
  const bool near = glm::distance(pixel_of(points[nearest]), context.ui->input.pointer) < look.px(kPointReach);
  if (pressed.activated) {
    const auto after = std::lower_bound(points.begin(), points.end(), at.x,
                                        [](const glm::dvec2& point, double x) { return point.x < x; });
    const bool room = (after == points.begin() || at.x - std::prev(after)->x >= kPointGap) &&
                      (after == points.end() || after->x - at.x >= kPointGap);
    if (!near && room && std::ssize(points) < kMostPoints)
      nearest = static_cast<int>(points.insert(after, at) - points.begin());
    context.skin->painting->dragged_point = nearest;
  }
  const int dragged = painting.dragged_point;
  if (pressed.held && dragged >= 0 && dragged < std::ssize(points)) {
    const double low = dragged > 0 ? points[dragged - 1].x + kPointGap : 0,
                 high = dragged + 1 < std::ssize(points) ? points[dragged + 1].x - kPointGap : 1;
    points[dragged] = {std::clamp(at.x, std::min(low, high), std::max(low, high)), at.y};
    context.ui->touch();
  }
  if (!pressed.held) painting.dragged_point = -1;
  if (pressed.right_clicked && near && std::ssize(points) > 2) points.erase(points.begin() + nearest);
  for (int i = 0; i < std::ssize(points); ++i)
    ImGui::GetWindowDrawList()->AddCircleFilled(
        im(pixel_of(points[i])),
        look.px(i == painting.dragged_point || (pressed.hovered && near && i == nearest) ? 4.5f : 3.5f),
        look.theme.text, 16);
  if (pressed.hovered && !pressed.held)
    operator_tooltip(context, *find_operator(context.operators, "skin.falloff_own"), rect);
}

// Draws a field for the angle of the active bone in the test pose, which bends one joint while the user paints weights.
// If the test pose bends another bone, draws the name of that bone and a button that straightens it.
void draw_test_pose(Context& context, Column& column) {
  const TestPose& test = *context.trial;
  if (why_not_bend(context).empty()) {
    double degrees = bend(context);
    bool committed = false;
    if (number_field(context.ui, "Test pose", column.property("Test pose"), degrees, -TestPose::kMost, TestPose::kMost,
                     "%+.0f", "\u00b0", true, committed) ||
        committed)
      set_bend(context, degrees);
  }
  if (test.degrees == 0 || bend(context) != 0) return;
  const Rect rect = column.property("");
  char text[64];
  std::snprintf(text, sizeof text, " bent by %+.0f\u00b0", test.degrees);
  const float width = context.ui->look.px(70);
  put_text(context.ui, context.ui->look.fonts.regular, context.ui->look.theme.text2,
           Rect{rect.low, {rect.high.x - width - context.ui->look.px(6), rect.high.y}}, test.bone + text);
  operator_button(context, "skin.unbend", {{rect.high.x - width, rect.low.y}, rect.high}, "Unbend");
}

// Draws the list of the user's presets, with buttons that save and delete a preset. The list says "Custom" if no
// preset equals the brush's settings, or if the label brush or the seam brush is on.
void draw_presets(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const bool paints_weights = !context.seams->brush && !context.skin->painting->labels->on;
  const int in_use = paints_weights ? brush_preset_in_use(context) : -1;
  std::vector<std::string> names;
  if (in_use < 0) names.push_back(brush_presets(context).empty() ? "None" : "Custom");
  for (const BrushPreset& preset : brush_presets(context)) names.push_back(preset.name);
  const Rect rect = column.property("Preset");
  const float side = look.px(24);
  const PathScope path(context.ui, "Preset");
  int chosen = std::max(0, in_use);
  const Rect list{rect.low, {rect.high.x - 2 * side - look.px(4), rect.high.y}};
  if (choice_field(context.ui, list, names, chosen) && (in_use >= 0 || chosen > 0))
    attempt(context, "Use brush preset",
            [name = names[static_cast<std::size_t>(chosen)]](Context& c) { use_brush_preset(c, name); });
  float x = list.high.x + look.px(4);
  for (const char* id : {"skin.preset_save", "skin.preset_delete"}) {
    const Operator& op = *find_operator(context.operators, id);
    const Rect place{{x, rect.low.y}, {x + side, rect.high.y}};
    x += side;
    if (button(context.ui, id, place, {op.icon, "", ButtonStyle::Flat})) run(context, op);
    if (ImGui::IsItemHovered()) operator_tooltip(context, op, place);
  }
}

}  // namespace

void draw_brush_section(Context& context, Column& column) {
  if (!column.begin_section("Brush", context.seams->brush ? "Seam" : name_of(context.skin->painting->kind)))
    return column.end_section();
  column.space(6);
  draw_presets(context, column);
  Painting& painting = *context.skin->painting;
  bool committed = false;
  const auto number = [&](const char* label, double& value, double low, double high, const char* format,
                          const char* unit) {
    number_field(context.ui, label, column.property(label), value, low, high, format, unit, true, committed);
  };
  constexpr int kOwn = 6;
  int shape = painting.falloff_curve.empty() ? static_cast<int>(painting.falloff) : kOwn;
  const Rect choice = column.property("Falloff");
  push_path(context.ui, "Falloff");
  if (choice_field(context.ui, choice, {"Smooth", "Sphere", "Root", "Sharp", "Linear", "Constant", "Custom"}, shape)) {
    if (shape == kOwn) {
      begin_falloff_curve(painting);
    } else {
      painting.falloff = static_cast<FalloffShape>(shape);
      painting.falloff_curve.clear();
    }
  }
  pop_path(context.ui);
  Rect curve = column.row(kCurveHeight + 6);
  curve.low.x = choice.low.x;
  curve.high = {choice.high.x, curve.low.y + context.ui->look.px(kCurveHeight)};
  draw_curve(context.ui, curve, falloff_of(painting));
  if (!painting.falloff_curve.empty()) edit_curve(context, curve, painting);
  double spacing = 100 * painting.spacing;
  number("Spacing", spacing, 5, 200, "%.0f", "%");
  painting.spacing = spacing / 100;
  if (painting.depth == BrushDepth::ToDepth) number("Depth", painting.depth_mm, 0.5, 200, "%.1f", "mm");
  if (painting.kind == BrushKind::JointCapsule) number("Blend", painting.blend_mm, 1, 300, "%.1f", "mm");
  int normalize = static_cast<int>(normalize_of(context));
  constexpr const char* kNormalize[] = {"skin.normalize_unlocked", "skin.normalize_all", "skin.normalize_off"};
  const Rect room = column.property("Normalize");
  push_path(context.ui, "Normalize");
  if (choice_field(context.ui, room, {"Unlocked", "All", "Off"}, normalize)) run(context, kNormalize[normalize]);
  if (ImGui::IsItemHovered()) operator_tooltip(context, *find_operator(context.operators, kNormalize[normalize]), room);
  pop_path(context.ui);
  checkbox(context.ui, "Bone hierarchy", column.property("Only"), "Bone hierarchy", painting.subtree);
  draw_test_pose(context, column);
  checkbox(context.ui, "Accumulate", column.property(""), "Accumulate", painting.accumulate);
  checkbox(context.ui, "Relative to locks", column.property(""), "Relative to locks", painting.relative_to_locks);
  column.space(6);
  column.end_section();
}

}  // namespace limber::editor
