// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the sidebar at the right. Its sections have a fixed order and scroll together; each section can be folded.
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/motion/constraint_panel.h"
#include "editor/motion/strip_properties_panel.h"
#include "editor/pose/clinical_angles_panel.h"
#include "editor/pose/pose_bone_panel.h"
#include "editor/pose/pose_library.h"
#include "editor/screen/steady.h"
#include "editor/skin/joint_repair.h"
#include "editor/skin/label_strokes.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

// Draws the handle that opens a closed sidebar, at the right edge of the views.
void draw_handle(Editor& editor) {
  const Look& look = editor.look;
  const Rect& rect = editor.layout.sidebar_handle;
  begin_region(editor, Region::Sidebar, "sidebar handle", rect, 0);
  const Pressed pressed = press_area(editor, "Open sidebar", rect);
  ImGui::GetWindowDrawList()->AddRectFilled(
      im(rect.low), im(rect.high), with_alpha(pressed.hovered ? look.theme.hover : look.theme.view_plate, 0.85f),
      look.px(5), ImDrawFlags_RoundCornersLeft);
  put_icon(look.fonts.regular, look.theme.view_text, rect, icon::kLeft);
  const Operator* op = find_operator(editor, "view.sidebar");
  if (pressed.hovered) operator_tooltip(editor, *op, rect);
  if (pressed.clicked) run(editor, *op);
  end_region(editor);
}

}  // namespace

void draw_sidebar(Editor& editor) {
  if (!editor.layout.sidebar_handle.empty()) return draw_handle(editor);
  const Rect& rect = editor.layout.sidebar;
  if (rect.empty()) return;
  begin_region(editor, Region::Sidebar, "sidebar", rect, editor.look.theme.panel);
  const float shift = sidebar_shift() / editor.look.scale;
  ImGui::PushID(static_cast<int>(editor.workspace));  // so that each workspace has its own scroll position
  {
    Column column(editor, "sections", rect);
    column.space(shift);
    draw_steps(editor, column);
    if (editor.workspace == Workspace::Skin) draw_label_brush_section(editor, column);
    if (editor.workspace == Workspace::Skin) draw_bones(editor, column);
    if (editor.workspace == Workspace::Resample) {
      draw_running(editor, column);
      draw_resample(editor, column);
      draw_gates(editor, column);
      draw_provenance(editor, column);
    }
    if (editor.workspace == Workspace::Skin && editor.document().weights) {
      draw_layers(editor, column);
      draw_brush_section(editor, column);
      draw_joint_repair(editor, column);
      draw_weight_problems(editor, column);
    }
    if (editor.workspace == Workspace::Skin) draw_seam_section(editor, column);
    if (editor.workspace == Workspace::Pose) {
      draw_strip_properties(editor, column);
      draw_pose_library(editor, column);
      draw_posed_bone(editor, column);
      draw_constraints(editor, column);
      draw_clinical_angles(editor, column);
      draw_live_volume(editor, column);
      draw_motion(editor, column);
    }
    draw_outliner(editor, column);
    draw_bone(editor, column);
    draw_fit_check(editor, column);
    if (editor.workspace == Workspace::Rig) draw_bone_table(editor, column);
    draw_display(editor, column);
    draw_tissues(editor, column);
    draw_tissue(editor, column);
    draw_image_section(editor, column);
    draw_clipping(editor, column);
    draw_under_cursor(editor, column);
    draw_measurements(editor, column);
    draw_history(editor, column);
    column.space(sidebar_rest(column.row(0).high.y + ImGui::GetScrollY() - rect.low.y) / editor.look.scale);
  }
  ImGui::PopID();
  end_region(editor);
}

}  // namespace limber::editor
