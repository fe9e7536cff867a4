// SPDX-License-Identifier: AGPL-3.0-or-later
// Panel of the bone table: each label of bone tissue, the rig bone that it follows and how that bone was found. A
// choice field in each row sets another bone.
#include <algorithm>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/selection.h"
#include "editor/rig/bone_table.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"
#include "editor/volume/tissue_edits.h"
#include "editor/volume/volume_edits.h"
#include "render/scene/weight_colormap.h"

namespace limber::editor {

namespace {

constexpr float kRow = 48, kMostRows = 6, kWord = 92;

std::string name_of(const MappedLabel& row, const Tissue* tissue) {
  const std::string name = tissue ? shown_name(*tissue) : "Label " + std::to_string(row.label);
  return name + (!row.side ? "" : *row.side == BodySide::Left ? ", left" : ", right");
}

// Returns the row's text. "Left" or "Right" comes first, because after a long name it would be cut off.
std::string shown_in_row(const MappedLabel& row, const Tissue* tissue) {
  const std::string name = name_of({.label = row.label}, tissue);
  return !row.side ? name : *row.side == BodySide::Left ? "Left: " + name : "Right: " + name;
}

std::string how(const MappedLabel& row) {
  return row.is_sure ? std::string(to_string(row.found_by)) : std::string("not sure");
}

std::string followed(const MappedLabel& row, const Armature& armature) {
  if (row.bones.empty()) return row.voxels == 0 ? "No voxels" : "No bone";
  const std::string first = armature.bones[static_cast<std::size_t>(row.bones[0])].name;
  return row.bones.size() == 1 ? first : first + " and " + std::to_string(row.bones.size() - 1) + " more";
}

void choose_bone(Context& context, const MappedLabel& row, const Rect& rect) {
  const Armature& armature = *context.document().armature;
  const bool by_hand = row.found_by == FoundBy::Map;
  std::vector<std::string> choices{by_hand ? "Automatic" : followed(row, armature)};
  for (const Bone& bone : armature.bones) choices.push_back(bone.name);
  int chosen = by_hand && !row.bones.empty() ? row.bones[0] + 1 : 0;
  if (choice_field(context.ui, rect, choices, chosen))
    map_label(context, row.label, row.side, chosen == 0 ? std::nullopt : std::optional(chosen - 1));
}

void draw_row(Context& context, Column& column, int index, const MappedLabel& row) {
  const Look& look = context.ui->look;
  const Rect rect = column.row(kRow);
  if (!ImGui::IsRectVisible(im(rect.low), im(rect.high))) return;
  const Tissue* tissue = context.document().tissues->find(row.label);
  const Armature& armature = *context.document().armature;
  const std::string name = name_of(row, tissue);
  const PathScope path(context.ui, name);
  if (index % 2) fill(rect, look.theme.row_alt);
  const float left = rect.low.x + look.px(10), right = rect.high.x - look.px(10), middle = rect.low.y + look.px(23);
  const std::string voxels = grouped(row.voxels);
  const float number = text_size(look.fonts.mono, voxels).x;
  const Rect top{{rect.low.x, rect.low.y}, {rect.high.x, middle}};
  const Pressed pressed = press_area(context.ui, "name", top);
  const glm::vec2 corner{left, std::round(top.centre().y - look.px(6))};
  if (!row.bones.empty()) {
    const glm::vec3 colour = render::bone_swatches(armature)[static_cast<std::size_t>(row.bones[0])];
    fill({corner, corner + look.px(14)}, rgb(colour.r, colour.g, colour.b), look.px(3));
  }
  put_text(context.ui, look.fonts.regular, look.theme.text,
           Rect{{left + look.px(22), top.low.y}, {right - number - look.px(8), top.high.y}}, shown_in_row(row, tissue));
  put_text(context.ui, look.fonts.mono, look.theme.text2, Rect{{right - number, top.low.y}, {right, top.high.y}},
           voxels, Align::Right);
  if (pressed.hovered)
    tooltip(context.ui, top, name,
            voxels + " voxels follow " + followed(row, armature) + ", found by " +
                std::string(to_string(row.found_by)) +
                (row.is_sure ? "." : "; no bone of the rig matches the tissue's name."));
  if (pressed.clicked) {
    select_tissue(context, row.label, false);
    if (!row.bones.empty()) context.selection->bone = row.bones[0], context.selection->bones = {row.bones[0]};
  }
  const Rect field{{left + look.px(22), middle}, {right - look.px(kWord), middle + look.px(22)}};
  choose_bone(context, row, field);
  const Rect word{{field.high.x + look.px(8), middle}, {right, middle + look.px(22)}};
  if (row.is_sure)
    return put_text(context.ui, look.fonts.regular,
                    row.found_by == FoundBy::Map ? look.theme.accent_text : look.theme.text2, word,
                    capitalized(how(row)));
  put_icon(look.fonts.regular, look.theme.warn, Rect{word.low, {word.low.x + look.px(18), word.high.y}},
           icon::kWarning);
  put_text(context.ui, look.fonts.regular, look.theme.warn, Rect{{word.low.x + look.px(20), word.low.y}, word.high},
           capitalized(how(row)));
}

void draw_rows(Context& context, Column& column, const std::vector<MappedLabel>& rows) {
  for (int i = 0; i < std::ssize(rows); ++i) draw_row(context, column, i, rows[static_cast<std::size_t>(i)]);
}

// Draws a warning with the number of bone map entries whose tissue or bone does not exist. The tooltip lists them.
void draw_left_out(Ui& ui, Column& column, const std::vector<std::string>& left_out) {
  if (left_out.empty()) return;
  const Look& look = ui.look;
  const Rect rect = column.row(28);
  put_icon(look.fonts.regular, look.theme.warn,
           Rect{{rect.low.x + look.px(8), rect.low.y}, {rect.low.x + look.px(28), rect.high.y}}, icon::kWarning);
  const std::string words = std::to_string(left_out.size()) +
                            (left_out.size() == 1 ? " entry names" : " entries name") + " no tissue or bone";
  put_text(ui, look.fonts.regular, look.theme.warn,
           Rect{{rect.low.x + look.px(32), rect.low.y}, {rect.high.x - look.px(10), rect.high.y}}, words);
  std::string all;
  for (const std::string& key : left_out) all += (all.empty() ? "" : ", ") + key;
  if (press_area(ui, "left out", rect).hovered) tooltip(ui, rect, "Entries not used", all);
}

void draw_foot(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const Rect rect = column.row(38);
  const float y = rect.low.y + look.px(6);
  float x = rect.low.x + look.px(10);
  for (const auto& [id, label] :
       {std::pair("rig.colour_bones", "Colours"), std::pair("rig.clear_bone_map", "Clear map")}) {
    const Operator* op = find_operator(context.operators, id);
    const float width = width_of_button(context.ui, {op->icon, label});
    operator_button(context, id, {{x, y}, {x + width, y + look.px(26)}}, label,
                    op->checked && op->checked(context) ? ButtonStyle::Soft : ButtonStyle::Plain);
    x += width + look.px(6);
  }
}

std::string summary(const BoneTable::Known& known) {
  const auto unsure =
      std::count_if(known.rows.begin(), known.rows.end(), [](const MappedLabel& row) { return !row.is_sure; });
  return std::to_string(known.rows.size()) + (unsure ? ", " + std::to_string(unsure) + " not sure" : "");
}

}  // namespace

void draw_bone_table(Context& context, Column& column) {
  if (!why_no_bone_table(context.document()).empty()) return;
  const auto& last = context.bone_table->known;
  const bool is_of_body =
      last && last->source.volume == context.document().volume && last->source.tissues == context.document().tissues;
  if (column.begin_section("Bone map", is_of_body ? summary(*last) : "", false)) {
    const BoneTable::Known* known = bone_table(context);
    if (!known) {
      put_text(context.ui, context.ui->look.fonts.regular, context.ui->look.theme.text3, column.row(24),
               "Finding the bones", Align::Centre);
    } else {
      // Rows are copied, because drawing a row may change the table. Rows whose bone is uncertain come first.
      std::vector<MappedLabel> rows = known->rows;
      std::stable_partition(rows.begin(), rows.end(), [](const MappedLabel& row) { return !row.is_sure; });
      draw_left_out(context.ui, column, known->left_out);
      if (static_cast<float>(rows.size()) <= kMostRows) {
        draw_rows(context, column, rows);
      } else {
        Column list(context.ui, "list", column.row(kRow * kMostRows));
        draw_rows(context, list, rows);
      }
      draw_foot(context, column);
    }
  }
  column.end_section();
}

}  // namespace limber::editor
