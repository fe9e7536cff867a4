// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the Brush section of the Skin workspace's sidebar: falloff, spacing, reach and normalization.
#include <algorithm>
#include <cstdio>

#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/labels/label_brush.h"
#include "editor/seams/seam_view.h"
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
void draw_curve(const Editor& editor, const Rect& rect, const Falloff& falloff) {
  const Look& look = editor.look;
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
void edit_curve(Editor& editor, const Rect& rect, Painting& painting) {
  const Look& look = editor.look;
  const Rect inside{rect.low + look.px(6), rect.high - look.px(6)};
  std::vector<glm::dvec2>& points = painting.falloff_curve;
  const auto pixel_of = [&](const glm::dvec2& point) {
    return glm::vec2(glm::mix(inside.low.x, inside.high.x, float(point.x)),
                     glm::mix(inside.high.y, inside.low.y, float(point.y)));
  };
  const glm::dvec2 at = glm::clamp(glm::dvec2((editor.input.pointer.x - inside.low.x) / inside.width(),
                                              (inside.high.y - editor.input.pointer.y) / inside.height()),
                                   0.0, 1.0);
  const Pressed pressed = press_area(editor, "curve", rect);
  int nearest = 0;
  for (int i = 1; i < std::ssize(points); ++i)
    if (glm::distance(pixel_of(points[i]), editor.input.pointer) <
        glm::distance(pixel_of(points[nearest]), editor.input.pointer))
      nearest = i;
  const bool near = glm::distance(pixel_of(points[nearest]), editor.input.pointer) < look.px(kPointReach);
  if (pressed.activated) {
    const auto after = std::lower_bound(points.begin(), points.end(), at.x,
                                        [](const glm::dvec2& point, double x) { return point.x < x; });
    const bool room = (after == points.begin() || at.x - std::prev(after)->x >= kPointGap) &&
                      (after == points.end() || after->x - at.x >= kPointGap);
    if (!near && room && std::ssize(points) < kMostPoints)
      nearest = static_cast<int>(points.insert(after, at) - points.begin());
    editor.skin->painting->dragged_point = nearest;
  }
  const int dragged = painting.dragged_point;
  if (pressed.held && dragged >= 0 && dragged < std::ssize(points)) {
    const double low = dragged > 0 ? points[dragged - 1].x + kPointGap : 0,
                 high = dragged + 1 < std::ssize(points) ? points[dragged + 1].x - kPointGap : 1;
    points[dragged] = {std::clamp(at.x, std::min(low, high), std::max(low, high)), at.y};
    editor.touch();
  }
  if (!pressed.held) painting.dragged_point = -1;
  if (pressed.right_clicked && near && std::ssize(points) > 2) points.erase(points.begin() + nearest);
  for (int i = 0; i < std::ssize(points); ++i)
    ImGui::GetWindowDrawList()->AddCircleFilled(
        im(pixel_of(points[i])),
        look.px(i == painting.dragged_point || (pressed.hovered && near && i == nearest) ? 4.5f : 3.5f),
        look.theme.text, 16);
  if (pressed.hovered && !pressed.held) operator_tooltip(editor, *find_operator(editor, "skin.falloff_own"), rect);
}

// Draws a field for the angle of the active bone in the test pose, which bends one joint while the user paints weights.
// If the test pose bends another bone, draws the name of that bone and a button that straightens it.
void draw_test_pose(Editor& editor, Column& column) {
  const TestPose& test = *editor.trial;
  if (why_not_bend(editor).empty()) {
    double degrees = bend(editor);
    bool committed = false;
    if (number_field(editor, "Test pose", column.property("Test pose"), degrees, -TestPose::kMost, TestPose::kMost,
                     "%+.0f", "\u00b0", true, committed) ||
        committed)
      set_bend(editor, degrees);
  }
  if (test.degrees == 0 || bend(editor) != 0) return;
  const Rect rect = column.property("");
  char text[64];
  std::snprintf(text, sizeof text, " bent by %+.0f\u00b0", test.degrees);
  const float width = editor.look.px(70);
  put_text(editor, editor.look.fonts.regular, editor.look.theme.text2,
           Rect{rect.low, {rect.high.x - width - editor.look.px(6), rect.high.y}}, test.bone + text);
  operator_button(editor, "skin.unbend", {{rect.high.x - width, rect.low.y}, rect.high}, "Unbend");
}

// Draws the list of the user's presets, with buttons that save and delete a preset. The list says "Custom" if no
// preset equals the brush's settings, or if the label brush or the seam brush is on.
void draw_presets(Editor& editor, Column& column) {
  const Look& look = editor.look;
  const bool paints_weights = !editor.seams->brush && !editor.skin->painting->labels->on;
  const int in_use = paints_weights ? brush_preset_in_use(editor) : -1;
  std::vector<std::string> names;
  if (in_use < 0) names.push_back(brush_presets(editor).empty() ? "None" : "Custom");
  for (const BrushPreset& preset : brush_presets(editor)) names.push_back(preset.name);
  const Rect rect = column.property("Preset");
  const float side = look.px(24);
  const PathScope path(editor, "Preset");
  int chosen = std::max(0, in_use);
  const Rect list{rect.low, {rect.high.x - 2 * side - look.px(4), rect.high.y}};
  if (choice_field(editor, list, names, chosen) && (in_use >= 0 || chosen > 0))
    attempt(editor, "Use brush preset",
            [name = names[static_cast<std::size_t>(chosen)]](Editor& e) { use_brush_preset(e, name); });
  float x = list.high.x + look.px(4);
  for (const char* id : {"skin.preset_save", "skin.preset_delete"}) {
    const Operator& op = *find_operator(editor, id);
    const Rect place{{x, rect.low.y}, {x + side, rect.high.y}};
    x += side;
    if (button(editor, id, place, {op.icon, "", ButtonStyle::Flat})) run(editor, op);
    if (ImGui::IsItemHovered()) operator_tooltip(editor, op, place);
  }
}

}  // namespace

void draw_brush_section(Editor& editor, Column& column) {
  if (!column.begin_section("Brush", editor.seams->brush ? "Seam" : name_of(editor.skin->painting->kind)))
    return column.end_section();
  column.space(6);
  draw_presets(editor, column);
  Painting& painting = *editor.skin->painting;
  bool committed = false;
  const auto number = [&](const char* label, double& value, double low, double high, const char* format,
                          const char* unit) {
    number_field(editor, label, column.property(label), value, low, high, format, unit, true, committed);
  };
  constexpr int kOwn = 6;
  int shape = painting.falloff_curve.empty() ? static_cast<int>(painting.falloff) : kOwn;
  const Rect choice = column.property("Falloff");
  push_path(editor, "Falloff");
  if (choice_field(editor, choice, {"Smooth", "Sphere", "Root", "Sharp", "Linear", "Constant", "Custom"}, shape)) {
    if (shape == kOwn) {
      begin_falloff_curve(painting);
    } else {
      painting.falloff = static_cast<FalloffShape>(shape);
      painting.falloff_curve.clear();
    }
  }
  pop_path(editor);
  Rect curve = column.row(kCurveHeight + 6);
  curve.low.x = choice.low.x;
  curve.high = {choice.high.x, curve.low.y + editor.look.px(kCurveHeight)};
  draw_curve(editor, curve, falloff_of(painting));
  if (!painting.falloff_curve.empty()) edit_curve(editor, curve, painting);
  double spacing = 100 * painting.spacing;
  number("Spacing", spacing, 5, 200, "%.0f", "%");
  painting.spacing = spacing / 100;
  if (painting.depth == BrushDepth::ToDepth) number("Depth", painting.depth_mm, 0.5, 200, "%.1f", "mm");
  if (painting.kind == BrushKind::JointCapsule) number("Blend", painting.blend_mm, 1, 300, "%.1f", "mm");
  int normalize = static_cast<int>(normalize_of(editor));
  constexpr const char* kNormalize[] = {"skin.normalize_unlocked", "skin.normalize_all", "skin.normalize_off"};
  const Rect room = column.property("Normalize");
  push_path(editor, "Normalize");
  if (choice_field(editor, room, {"Unlocked", "All", "Off"}, normalize)) run(editor, kNormalize[normalize]);
  if (ImGui::IsItemHovered()) operator_tooltip(editor, *find_operator(editor, kNormalize[normalize]), room);
  pop_path(editor);
  checkbox(editor, "Bone hierarchy", column.property("Only"), "Bone hierarchy", painting.subtree);
  draw_test_pose(editor, column);
  checkbox(editor, "Accumulate", column.property(""), "Accumulate", painting.accumulate);
  checkbox(editor, "Relative to locks", column.property(""), "Relative to locks", painting.relative_to_locks);
  column.space(6);
  column.end_section();
}

}  // namespace limber::editor
