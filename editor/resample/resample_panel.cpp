// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the Resample section of the sidebar: method, FEM settings, output spacing, and the button that starts the job.
#include <array>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/resampling_settings.h"
#include "editor/resample/resample_job.h"
#include "editor/resample/results.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

namespace {

// Draws the FEM settings: mesh quality, and contact of skin with skin.
void draw_fem(Context& context, Column& column) {
  auto& settings = *context.resampling;
  const Rect quality = column.property("Quality");
  const PathScope path(context.ui, "Quality");
  int chosen = settings.quality == "draft" ? 0 : settings.quality == "fine" ? 2 : 1;
  if (choice_field(context.ui, quality, {"Draft", "Normal", "Fine"}, chosen))
    settings.quality = std::array{"draft", "normal", "fine"}[static_cast<std::size_t>(chosen)];
  if (ImGui::IsItemHovered())
    tooltip(context.ui, quality, "Quality",
            "Number of tetrahedra across the thinnest bent limb: 8 (draft), 12 (normal), or 24 around joints (fine). A "
            "finer mesh takes longer.");
  const Rect contact = column.property("Contact");
  checkbox(context.ui, "Contact", contact, "Skin touches skin", settings.contact);
  if (ImGui::IsItemHovered())
    tooltip(context.ui, contact, "Skin touches skin",
            "In folds, skin surfaces press against each other instead of passing through each other.");
  operator_box(context, "result.watch", column.property("During solve"), "Watch the solve");
}

}  // namespace

void draw_resample(Context& context, Column& column) {
  const Look& look = context.ui->look;
  if (column.begin_section("Resample")) {
    auto& settings = *context.resampling;
    const Rect methods = column.row(30);
    const std::vector<std::string> ids = method_operators(Methods::All);
    const float width = std::floor((methods.width() - look.px(20)) / float(ids.size()));
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const Operator* op = find_operator(context.operators, ids[i]);
      const float x = methods.low.x + look.px(10) + float(i) * width;
      operator_button(context, ids[i], {{x, methods.low.y}, {x + width - look.px(1), methods.low.y + look.px(26)}},
                      op->label, op->checked(context) ? ButtonStyle::Chosen : ButtonStyle::Plain);
    }
    if (settings.method == kFiniteElements) draw_fem(context, column);
    const Rect spacing = column.property("Voxel size");
    bool committed = false;
    const char* format = settings.spacing > 0 ? "%.2f" : "as input";
    number_field(context.ui, "Voxel size", spacing, settings.spacing, 0, 20, format, settings.spacing > 0 ? "mm" : "",
                 false, committed);
    if (ImGui::IsItemHovered())
      tooltip(context.ui, spacing, "Voxel size", "Voxel size of the resampled volume. 0 = same as the volume at rest.");
    const Rect apart = column.property("Joints");
    checkbox(context.ui, "Keep bones apart", apart, "Keep bones apart", settings.bones_apart);
    if (ImGui::IsItemHovered())
      tooltip(
          context.ui, apart, "Keep bones apart",
          "Shift each bent joint just enough that its bones do not overlap, by up to 5 percent of the shorter bone's "
          "length. Off: shift by one voxel at most, so that the result matches the preview. Shifts do not turn bones.");
    const Rect exact = column.property("Volumes");
    checkbox(context.ui, "Mass-exact", exact, "Mass-exact", settings.mass_exact);
    if (ImGui::IsItemHovered())
      tooltip(context.ui, exact, "Mass-exact",
              "Restore the rest volume of each soft tissue after resampling. Changes as few voxels as possible at the "
              "borders of tissues, the least certain ones first. Does not change bones.");
    column.space(6);
    const Rect row = column.row(30);
    const Rect place{{row.low.x + look.px(10), row.low.y}, {row.high.x - look.px(10), row.low.y + look.px(28)}};
    operator_button(context, "resample.run", place, "Resample this pose", ButtonStyle::Primary);
    const Operator* op = find_operator(context.operators, "resample.run");
    const std::string reason = disabled_reason(context, *op);
    const Rect note = column.row(24);
    const Document& document = context.document();
    const std::string words =
        !reason.empty()
            ? reason
            : name_of_pose(*document.armature, document.pose ? *document.pose : rest_pose(*document.armature));
    put_text(context.ui, look.fonts.small, reason.empty() ? look.theme.text2 : look.theme.warn,
             Rect{{note.low.x + look.px(10), note.low.y}, {note.high.x - look.px(10), note.high.y}}, words);
  }
  column.end_section();
}

}  // namespace limber::editor
