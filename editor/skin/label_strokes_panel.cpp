// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the section "Label brush" of the Skin workspace's sidebar: the tissue that strokes paint, the tissues that
// they may replace, and edits of the whole painted tissue.
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/labels/label_edits.h"
#include "editor/skin/label_strokes.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/section.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

// Draws the colour of the painted tissue, and a list in which the user selects another tissue.
void draw_painted_tissue(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const Rect rect = column.property("Tissue");
  const auto tissues = context.document().tissues;
  if (!tissues || tissues->tissues.empty())
    return put_text(context.ui, look.fonts.regular, look.theme.text3, rect, "Add a tissue first");
  std::vector<std::string> names;
  int chosen = -1;
  for (const Tissue& tissue : tissues->tissues) {
    if (context.selection->tissue == tissue.label) chosen = static_cast<int>(names.size());
    names.push_back(shown_name(tissue));
  }
  if (chosen < 0) names.push_back("Select...");
  const float side = look.px(14), y = std::round(rect.centre().y - side / 2);
  const glm::vec3 colour = chosen < 0 ? glm::vec3(0) : tissues->tissues[static_cast<std::size_t>(chosen)].colour;
  if (chosen >= 0)
    fill({{rect.low.x, y}, {rect.low.x + side, y + side}}, rgb(colour.r, colour.g, colour.b), look.px(3));
  const PathScope scope(context.ui, "Tissue");
  int picked = chosen < 0 ? static_cast<int>(names.size()) - 1 : chosen;
  if (choice_field(context.ui, {{rect.low.x + side + look.px(6), rect.low.y}, rect.high}, names, picked) &&
      picked < std::ssize(tissues->tissues))
    select_tissue(context, tissues->tissues[static_cast<std::size_t>(picked)].label, false);
}

// Draws a drop-down list of operators, exactly one of which is on. `words` are the operators' names in this list.
void draw_choice(Context& context, Column& column, const char* name, const std::vector<const char*>& ids,
                 const std::vector<std::string>& words) {
  int chosen = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const Operator* op = find_operator(context.operators, ids[i]);
    if (op->checked(context)) chosen = static_cast<int>(i);
  }
  const Rect field = column.property(name);
  const PathScope scope(context.ui, name);
  if (choice_field(context.ui, field, words, chosen)) run(context, ids[static_cast<std::size_t>(chosen)]);
  if (ImGui::IsItemHovered())
    operator_tooltip(context, *find_operator(context.operators, ids[static_cast<std::size_t>(chosen)]), field);
}

void draw_range(Context& context, Column& column, LabelBrush& brush) {
  if (!context.views->image) return;
  const Rect rect = column.property("");
  const bool was_in_range = brush.in_range;
  checkbox(context.ui, "Value range", rect, "Value range", brush.in_range);
  if (ImGui::IsItemHovered()) operator_tooltip(context, *find_operator(context.operators, "labels.in_range"), rect);
  if (!brush.in_range) return;
  if (!was_in_range) begin_range(context);
  const GreyLevels& image = *context.views->image->image;
  bool committed = false;
  number_field(context.ui, "From", column.property("From"), brush.low, image.least, image.most(), "%.0f", "", true,
               committed);
  number_field(context.ui, "To", column.property("To"), brush.high, image.least, image.most(), "%.0f", "", true,
               committed);
}

// Draws the buttons of edits that change the whole tissue, in two columns.
void draw_edits(Context& context, Column& column) {
  constexpr const char* kEdits[] = {"labels.fill_holes", "labels.islands", "labels.grow",
                                    "labels.shrink",     "labels.split",   "labels.new_tissue"};
  for (std::size_t i = 0; i < std::size(kEdits); i += 2) {
    const Rect row = column.row(30);
    const float middle = std::round(row.centre().x), top = row.low.y + context.ui->look.px(2),
                gap = context.ui->look.px(3);
    for (std::size_t side = 0; side < 2; ++side) {
      const Operator* op = find_operator(context.operators, kEdits[i + side]);
      const Rect place =
          side == 0 ? Rect{{row.low.x + context.ui->look.px(10), top}, {middle - gap, top + context.ui->look.px(26)}}
                    : Rect{{middle + gap, top}, {row.high.x - context.ui->look.px(10), top + context.ui->look.px(26)}};
      operator_button(context, op->id, place, op->id == "labels.islands" ? "Islands..." : op->label);
    }
  }
}

}  // namespace

void draw_label_brush_section(Context& context, Column& column) {
  LabelBrush& brush = *context.skin->painting->labels;
  if (!brush.on) return;
  if (!column.begin_section("Label brush")) return column.end_section();
  column.space(6);
  draw_painted_tissue(context, column);
  bool committed = false;
  number_field(context.ui, "Radius", column.property("Radius"), context.skin->painting->radius, Painting::kLeastRadius,
               Painting::kMostRadius, "%.1f", "mm", true, committed);
  draw_choice(context, column, "Paint over",
              {"labels.over_all", "labels.over_air", "labels.over_tissue", "labels.over_underneath"},
              {"All", "Air", "Tissue", "One tissue"});
  draw_choice(context, column, "Erase to", {"labels.erase_to_surroundings", "labels.erase_to_air"},
              {"Surroundings", "Air"});
  const Rect flat = column.property("");
  checkbox(context.ui, "One slice", flat, "Only one slice", brush.flat);
  if (ImGui::IsItemHovered()) operator_tooltip(context, *find_operator(context.operators, "labels.flat"), flat);
  draw_range(context, column, brush);
  column.space(4);
  draw_edits(context, column);
  column.space(6);
  column.end_section();
}

}  // namespace limber::editor
