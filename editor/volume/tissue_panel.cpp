// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the sections "Tissue" (the active tissue's name, colour, opacity and material) and "Under the cursor".
#include <cstdio>

#include "core/tissue/tissue_rows.h"
#include "editor/context/context.h"
#include "editor/context/field_edit.h"
#include "editor/context/panels.h"
#include "editor/context/selection.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/tooltip.h"
#include "editor/volume/shown_image.h"
#include "editor/volume/tissue_edits.h"

namespace limber::editor {

namespace {

// Returns a text for the user that says whether a property of a tissue, such as its density, has the usual value for
// this kind of tissue, and where the usual value comes from.
std::string where_from(const Tissue& tissue, double Tissue::*member, const char* format, const char* unit,
                       std::string_view source) {
  Tissue usual;
  usual.name = tissue.name;
  usual.kind = tissue.kind;
  apply_kind_defaults(usual);
  const std::string kind(tissue.name.empty() ? to_string(tissue.kind) : tissue.name),
      from = " (" + std::string(source) + ").";
  if (tissue.*member == usual.*member) return "This is the usual value for " + kind + from;
  char number[40];
  std::snprintf(number, sizeof number, format, usual.*member);
  return "Set by the tissue table or by hand. The usual value for " + kind + " is " + number + (*unit ? " " : "") +
         unit + from;
}

// Draws a field for one of the tissue's numbers. The document changes once, when the drag or the typing ends.
void draw_number(Context& context, Column& column, const Tissue& tissue, const char* label, double Tissue::*member,
                 double low, double high, const char* format, const char* unit, std::string_view source) {
  const Rect rect = column.property(label);
  auto& edited = context.field_edit->number;
  double value = edited.name == label ? edited.value : tissue.*member;
  bool committed = false;
  if (number_field(context.ui, label, rect, value, low, high, format, unit, false, committed)) edited = {label, value};
  if (ImGui::IsItemHovered()) tooltip(context.ui, rect, label, where_from(tissue, member, format, unit, source));
  if (!committed || edited.name != label) return;
  Tissue next = tissue;
  next.*member = edited.value;
  edited = {};
  set_tissue(context, std::string("Set ") + label + " of " + shown_name(tissue), next);
}

void draw_opacity(Context& context, Column& column, const Tissue& tissue) {
  const Rect rect = column.property("Opacity");
  const TissueLook shown = look_of(context.document(), tissue.label);
  auto& edited = context.field_edit->number;
  double percent = edited.name == "Opacity" ? edited.value : shown.opacity * 100.0;
  bool committed = false;
  if (number_field(context.ui, "Opacity", rect, percent, 0, 100, "%.0f", "%", true, committed)) {
    edited = {"Opacity", percent};
    preview_look(context, tissue.label, {shown.visible, static_cast<float>(percent / 100)});
  }
  if (!committed || edited.name != "Opacity") return;
  const auto opacity = static_cast<float>(edited.value / 100);
  edited = {};
  set_look(context, "Set opacity of " + shown_name(tissue), tissue.label, {shown.visible, opacity});
}

void draw_kind(Context& context, Column& column, const Tissue& tissue) {
  std::vector<std::string> names;
  for (int kind = 0; kind <= static_cast<int>(TissueKind::Nail); ++kind)
    names.push_back(capitalized(std::string(to_string(static_cast<TissueKind>(kind)))));
  int chosen = static_cast<int>(tissue.kind);
  const Rect field = column.property("Kind");
  const PathScope scope(context.ui, "Kind");
  if (choice_field(context.ui, field, names, chosen)) set_kind(context, tissue.label, static_cast<TissueKind>(chosen));
}

void draw_colour(Context& context, Column& column, const Tissue& tissue) {
  const Look& look = context.ui->look;
  const Rect rect = column.property("Colour");
  const glm::vec3 colour = context.field_edit->colour.value_or(tissue.colour);
  const Rect swatch{rect.low, {rect.high.x - look.px(56), rect.high.y}};
  if (press_area(context.ui, "Colour", swatch).clicked) ImGui::OpenPopup("colour");
  fill(swatch, rgb(colour.r, colour.g, colour.b), look.px(4));
  char hex[8];
  std::snprintf(hex, sizeof hex, "%02X%02X%02X", static_cast<int>(colour.r * 255 + 0.5f),
                static_cast<int>(colour.g * 255 + 0.5f), static_cast<int>(colour.b * 255 + 0.5f));
  put_text(context.ui, look.fonts.mono, look.theme.text2, Rect{{swatch.high.x, rect.low.y}, rect.high}, hex,
           Align::Right);
  if (ImGui::BeginPopup("colour")) {
    float picked[3] = {colour.r, colour.g, colour.b};
    if (ImGui::ColorPicker3("##picker", picked,
                            ImGuiColorEditFlags_NoSidePreview | ImGuiColorEditFlags_NoSmallPreview)) {
      Tissue next = tissue;
      next.colour = {picked[0], picked[1], picked[2]};
      context.field_edit->colour = next.colour;
      preview_tissue(context, next);
    }
    ImGui::EndPopup();
  } else if (context.field_edit->colour) {
    Tissue next = tissue;
    next.colour = *context.field_edit->colour;
    context.field_edit->colour.reset();
    set_tissue(context, "Set colour of " + shown_name(tissue), next);
  }
}

// Draws the skin weights of the voxel under the pointer. There are always four rows, so that the rest of the panel does
// not shift when the pointer moves.
void draw_weights(Ui& ui, Column& column, const std::vector<BoneWeight>& weights) {
  const Look& look = ui.look;
  for (std::size_t i = 0; i < 4; ++i) {
    const Rect row = column.row(22);
    const float left = row.low.x + look.px(10), bar = row.high.x - look.px(130), right = row.high.x - look.px(10);
    if (i >= weights.size()) {
      if (i == 0)
        put_text(ui, look.fonts.regular, look.theme.text3, Rect{{left, row.low.y}, row.high}, "No weights here");
      continue;
    }
    put_text(ui, look.fonts.regular, look.theme.text2, Rect{{left, row.low.y}, {bar - look.px(8), row.high.y}},
             weights[i].bone);
    const float y = std::round(row.centre().y - look.px(3)), length = look.px(64);
    fill({{bar, y}, {bar + length, y + look.px(6)}}, look.theme.field, look.px(3));
    fill({{bar, y}, {bar + std::max(look.px(2), length * static_cast<float>(weights[i].value)), y + look.px(6)}},
         look.theme.accent_text, look.px(3));
    char text[16];
    std::snprintf(text, sizeof text, "%.3f", weights[i].value);
    put_text(ui, look.fonts.mono, look.theme.text, Rect{row.low, {right, row.high.y}}, text, Align::Right);
  }
}

}  // namespace

void draw_tissue(Context& context, Column& column) {
  const Document& document = context.document();
  const Tissue* found =
      document.tissues && context.selection->tissue ? document.tissues->find(*context.selection->tissue) : nullptr;
  if (!found) return;
  const Tissue tissue = *found;
  if (column.begin_section("Tissue", shown_name(tissue))) {
    column.space(6);
    std::string name = tissue.name;
    if (text_field(context.ui, "Name", column.property("Name"), name)) rename_tissue(context, tissue.label, name);
    draw_kind(context, column, tissue);
    draw_colour(context, column, tissue);
    draw_opacity(context, column, tissue);
    const MaterialSources sources = material_sources(tissue.kind);
    draw_number(context, column, tissue, "Density", &Tissue::density, 0.001, 25, "%.3f", "g/cm\u00b3",
                usual_density(tissue).source);
    draw_number(context, column, tissue, "Stiffness", &Tissue::young_modulus, 0.01, 1e6, "%.1f", "kPa",
                sources.stiffness);
    draw_number(context, column, tissue, "Poisson ratio", &Tissue::poisson_ratio, 0, 0.4999, "%.4f", "",
                sources.poisson);
    column.space(6);
  }
  column.end_section();
}

void draw_under_cursor(Context& context, Column& column) {
  if (!context.document().volume) return;
  const Look& look = context.ui->look;
  if (column.begin_section("Under the cursor")) {
    column.space(4);
    const Hover& hover = context.views->hover;
    // The position is also shown at a point without a label, if the grey image has a value there.
    const std::optional<double> value = image_value_at_pointer(context.views);
    const bool is_known = hover.inside || value;
    const Tissue* tissue =
        hover.inside && context.document().tissues ? context.document().tissues->find(hover.label) : nullptr;
    const Rect rect = column.row(24);
    if (tissue) {
      const float side = look.px(14), y = std::round(rect.centre().y - side / 2);
      const Rect swatch{{rect.low.x + look.px(10), y}, {rect.low.x + look.px(10) + side, y + side}};
      fill(swatch, rgb(tissue->colour.r, tissue->colour.g, tissue->colour.b), look.px(3));
      outline(swatch, look.theme.line2, look.px(3), look.line());
      put_text(context.ui, look.fonts.regular, look.theme.text,
               Rect{{rect.low.x + look.px(32), rect.low.y}, {rect.high.x - look.px(60), rect.high.y}},
               shown_name(*tissue));
      put_text(context.ui, look.fonts.mono, look.theme.text2, Rect{rect.low, {rect.high.x - look.px(10), rect.high.y}},
               std::to_string(tissue->label), Align::Right);
    } else {
      put_text(context.ui, look.fonts.regular, look.theme.text3,
               Rect{{rect.low.x + look.px(10), rect.low.y}, rect.high}, value ? "No label" : "Outside");
    }
    char text[80] = "-";
    Rect position = column.property("Position");
    position.low.x -= look.px(52);  // three coordinates need more room than the other values
    if (is_known) std::snprintf(text, sizeof text, "%.1f %.1f %.1f mm", hover.point.x, hover.point.y, hover.point.z);
    put_text(context.ui, look.fonts.mono, look.theme.text, position, text, Align::Right);
    std::snprintf(text, sizeof text, "-");
    const Rect voxel = column.property("Voxel");
    if (is_known) std::snprintf(text, sizeof text, "%d %d %d", hover.voxel.x, hover.voxel.y, hover.voxel.z);
    put_text(context.ui, look.fonts.mono, look.theme.text, voxel, text, Align::Right);
    if (context.views->image)
      put_text(context.ui, look.fonts.mono, look.theme.text, column.property("Image"),
               value ? text_of_image_value(context.views, *value) : "-", Align::Right);
    if (context.document().weights) draw_weights(context.ui, column, hover.weights);
    column.space(4);
  }
  column.end_section();
}

}  // namespace limber::editor
