// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the section "Joint" of the Skin workspace's sidebar: the joint of the active bone, a button that repairs it,
// and how much the last repair has improved.
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/operator_button.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/joint_repair.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"
#include "editor/ui/section.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

void put_row(Ui& ui, Column& column, const std::string& label, const std::string& text, Colour colour) {
  put_text(ui, ui.look.fonts.regular, colour, column.property(label), text);
}

std::string joint_name(const Context& context) {
  const auto bone = skin_bone(context);
  if (!bone) return "No bone is active";
  const auto& bones = context.document().armature->bones;
  const Bone& child = bones[static_cast<std::size_t>(*bone)];
  return child.parent < 0 ? child.name + " has no joint"
                          : bones[static_cast<std::size_t>(child.parent)].name + " to " + child.name;
}

std::string grouped_mean(double voxels) { return grouped(static_cast<std::int64_t>(voxels + 0.5)); }

void draw_gain(Ui& ui, Column& column, const RepairedJoint& repaired) {
  const Look& look = ui.look;
  const JointRepair& figures = repaired.figures;
  const Colour colour = figures.is_better ? look.theme.ok : look.theme.text2;
  put_row(ui, column, "Last repaired", figures.is_better ? repaired.bone : repaired.bone + ": no change",
          look.theme.text);
  char text[64];
  std::snprintf(text, sizeof text, "%.2f to %.2f %%", mean_sum(figures.before), mean_sum(figures.after));
  put_row(ui, column, "Volume change", text, colour);
  put_row(ui, column, "Overlap, voxels",
          grouped_mean(mean_overlap(figures.before)) + " to " + grouped_mean(mean_overlap(figures.after)), colour);
  if (figures.starts_from_capsule) {
    std::snprintf(text, sizeof text, "%.0f mm", figures.widths.flexor);
    put_row(ui, column, "Flexor blend", text, look.theme.text);
    std::snprintf(text, sizeof text, "%.0f mm", figures.widths.extensor);
    put_row(ui, column, "Extensor blend", text, look.theme.text);
  }
}

}  // namespace

void draw_joint_repair(Context& context, Column& column) {
  if (column.begin_section("Joint", repairs_joint(context.jobs) ? "repairing" : "", false)) {
    const Look& look = context.ui->look;
    column.space(4);
    put_row(context.ui, column, "Joint", joint_name(context), look.theme.text);
    const Rect row = column.row(34);
    const std::string label = "Repair this joint";
    const float width = width_of_button(context.ui, {icon::kTick, label});
    operator_button(
        context, "skin.repair_joint",
        {{row.low.x + look.px(10), row.low.y + look.px(4)}, {row.low.x + look.px(10) + width, row.low.y + look.px(30)}},
        label);
    const auto repaired = context.skin->painting->repaired_joint;
    if (repaired && repaired->in.lock() == context.document().weights) draw_gain(context.ui, column, *repaired);
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
