// SPDX-License-Identifier: AGPL-3.0-or-later
// The Skin workspace's brush: how it fades, how its dabs follow one another, what it reaches.
#include <algorithm>

#include "editor/fields.h"
#include "editor/painting.h"
#include "editor/panels/column.h"
#include "editor/panels/panels.h"
#include "editor/skin_display.h"

namespace limber::editor {

namespace {

constexpr float kCurveHeight = 56;
constexpr int kCurvePoints = 48;

// How the brush fades from its middle, at the left, to its rim.
void draw_curve(const Editor& editor, const Rect& rect, const Falloff& falloff) {
  const Look& look = editor.look;
  fill(rect, look.theme.field, look.px(4));
  const Rect inside{rect.low + look.px(6), rect.high - look.px(6)};
  std::vector<ImVec2> line;
  for (int i = 0; i <= kCurvePoints; ++i) {
    const float share = float(i) / kCurvePoints;
    line.push_back(im(glm::vec2(glm::mix(inside.low.x, inside.high.x, share), glm::mix(inside.high.y, inside.low.y, std::clamp(falloff(share), 0.0f, 1.0f)))));
  }
  ImGui::GetWindowDrawList()->AddPolyline(line.data(), static_cast<int>(line.size()), look.theme.accent_text, 0, 1.5f * look.scale);
}

}  // namespace

void draw_brush_section(Editor& editor, Column& column) {
  if (!column.begin_section("Brush", name_of(editor.skin->painting->kind))) return column.end_section();
  column.space(6);
  Painting& painting = *editor.skin->painting;
  bool committed = false;
  const auto number = [&](const char* label, double& value, double low, double high, const char* format, const char* unit) {
    number_field(editor, label, column.property(label), value, low, high, format, unit, true, committed);
  };
  int shape = static_cast<int>(painting.falloff);
  const Rect choice = column.property("Falloff");
  push_path(editor, "Falloff");
  if (choice_field(editor, choice, {"Smooth", "Sphere", "Root", "Sharp", "Linear", "Constant"}, shape)) painting.falloff = static_cast<FalloffShape>(shape);
  pop_path(editor);
  Rect curve = column.row(kCurveHeight + 6);
  curve.low.x = choice.low.x;
  curve.high = {choice.high.x, curve.low.y + editor.look.px(kCurveHeight)};
  draw_curve(editor, curve, Falloff(painting.falloff));
  double spacing = 100 * painting.spacing;
  number("Spacing", spacing, 5, 200, "%.0f", "%");
  painting.spacing = spacing / 100;
  if (painting.depth == BrushDepth::ToDepth) number("Depth", painting.depth_mm, 0.5, 200, "%.1f", "mm");
  if (painting.kind == BrushKind::JointCapsule) number("Blend", painting.blend_mm, 1, 300, "%.1f", "mm");
  checkbox(editor, "Below the bone", column.property("Only"), "Below the bone", painting.subtree);
  checkbox(editor, "Accumulate", column.property(""), "Accumulate", painting.accumulate);
  column.space(6);
  column.end_section();
}

}  // namespace limber::editor
