// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the sidebar at the right. Its sections have a fixed order and scroll together; each section can be folded.
#include "editor/context/context.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/screen.h"
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
void draw_handle(Context& context) {
  const Look& look = context.ui->look;
  const Rect& rect = context.screen->layout.sidebar_handle;
  begin_region(context.ui, Region::Sidebar, "sidebar handle", rect, 0);
  const Pressed pressed = press_area(context.ui, "Open sidebar", rect);
  ImGui::GetWindowDrawList()->AddRectFilled(
      im(rect.low), im(rect.high), with_alpha(pressed.hovered ? look.theme.hover : look.theme.view_plate, 0.85f),
      look.px(5), ImDrawFlags_RoundCornersLeft);
  put_icon(look.fonts.regular, look.theme.view_text, rect, icon::kLeft);
  const Operator* op = find_operator(context.operators, "view.sidebar");
  if (pressed.hovered) operator_tooltip(context, *op, rect);
  if (pressed.clicked) run(context, *op);
  end_region(context.ui);
}

}  // namespace

void draw_sidebar(Context& context) {
  if (!context.screen->layout.sidebar_handle.empty()) return draw_handle(context);
  const Rect& rect = context.screen->layout.sidebar;
  if (rect.empty()) return;
  begin_region(context.ui, Region::Sidebar, "sidebar", rect, context.ui->look.theme.panel);
  const float shift = sidebar_shift() / context.ui->look.scale;
  ImGui::PushID(static_cast<int>(context.workspace()));  // so that each workspace has its own scroll position
  {
    Column column(context.ui, "sections", rect);
    column.space(shift);
    draw_steps(context, column);
    if (context.workspace() == Workspace::Skin) draw_label_brush_section(context, column);
    if (context.workspace() == Workspace::Skin) draw_bones(context, column);
    if (context.workspace() == Workspace::Resample) {
      draw_running(context, column);
      draw_resample(context, column);
      draw_gates(context, column);
      draw_provenance(context, column);
    }
    if (context.workspace() == Workspace::Skin && context.document().weights) {
      draw_layers(context, column);
      draw_brush_section(context, column);
      draw_joint_repair(context, column);
      draw_weight_problems(context, column);
    }
    if (context.workspace() == Workspace::Skin) draw_seam_section(context, column);
    if (context.workspace() == Workspace::Pose) {
      draw_strip_properties(context, column);
      draw_pose_library(context, column);
      draw_posed_bone(context, column);
      draw_constraints(context, column);
      draw_clinical_angles(context, column);
      draw_live_volume(context, column);
      draw_motion(context, column);
    }
    draw_outliner(context, column);
    draw_bone(context, column);
    draw_fit_check(context, column);
    if (context.workspace() == Workspace::Rig) draw_bone_table(context, column);
    draw_display(context, column);
    draw_tissues(context, column);
    draw_tissue(context, column);
    draw_image_section(context, column);
    draw_clipping(context, column);
    draw_under_cursor(context, column);
    draw_measurements(context, column);
    draw_history(context, column);
    column.space(sidebar_rest(column.row(0).high.y + ImGui::GetScrollY() - rect.low.y) / context.ui->look.scale);
  }
  ImGui::PopID();
  end_region(context.ui);
}

}  // namespace limber::editor
