// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws over a view the legend of marked voxels with their counts. The legend of a difference has a row for volume A
// and a row for volume B, with two counts: voxels where the other volume has no tissue, and voxels where the other
// volume has another tissue. A further row has the counts of the tissue under the pointer. The legend of an overlap
// counts the posed voxels to which two points of the body move.
#include <algorithm>
#include <array>

#include "editor/context/comparison.h"
#include "editor/context/context.h"
#include "editor/context/panels.h"
#include "editor/context/views.h"
#include "editor/resample/difference_overlay.h"
#include "editor/resample/overlap_overlay.h"
#include "editor/resample/results.h"
#include "editor/volume/tissue_edits.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 340, kRow = 22, kPad = 10, kMargin = 8, kNumber = 92;

struct Row {
  std::string letter, name;
  // Voxel counts in the legend's two columns; no value: not computed yet.
  std::optional<std::array<std::int64_t, 2>> counts;
  std::optional<std::array<glm::vec3, 2>> marks;  // swatch colours in the two columns, sRGB; none: no swatches
};
struct Legend {
  std::string title;
  std::array<const char*, 2> columns;
  std::vector<Row> rows;
  std::string note;  // text below the rows; may be empty
};

void draw_row(Context& context, const Rect& row, const Row& words) {
  const Look& look = context.ui->look;
  const float left = row.high.x - look.px(2 * kNumber);
  put_text(context.ui, look.fonts.semibold, look.theme.view_text, Rect{row.low, {row.low.x + look.px(18), row.high.y}},
           words.letter);
  put_text(context.ui, look.fonts.regular, look.theme.view_text,
           Rect{{row.low.x + look.px(words.letter.empty() ? 0 : 18), row.low.y}, {left, row.high.y}}, words.name);
  for (std::size_t column = 0; words.counts && column < 2; ++column) {
    const float right = left + look.px(kNumber) * static_cast<float>(column + 1);
    const std::string digits = grouped((*words.counts)[column]);
    put_text(context.ui, look.fonts.mono, look.theme.view_text,
             Rect{{right - look.px(kNumber), row.low.y}, {right, row.high.y}}, digits, Align::Right);
    if (!words.marks) continue;
    const glm::vec3& mark = (*words.marks)[column];
    put_swatch(look, {right - text_size(look.fonts.mono, digits).x - look.px(22), row.centre().y - look.px(7)},
               rgb(mark.r, mark.g, mark.b));
  }
}

bool draw_legend(Context& context, const Rect& view, const Legend& legend) {
  const Look& look = context.ui->look;
  if (view.width() < look.px(300) || view.height() < look.px(180)) return false;
  const float lines = static_cast<float>(1 + legend.rows.size() + !legend.note.empty());
  const glm::vec2 low{view.low.x + look.px(kMargin), view.high.y - look.px(kMargin + lines * kRow + 8)};
  const Rect box{
      low, low + glm::vec2(std::min(look.px(kWidth), view.width() - look.px(2 * kMargin)), look.px(lines * kRow + 8))};
  fill(box, with_alpha(look.theme.view_plate, 0.85f), look.px(5));
  register_widget(context.ui, "legend", box);
  float y = box.low.y + look.px(4);
  const auto next = [&] {
    const Rect row{{box.low.x + look.px(kPad), y}, {box.high.x - look.px(kPad), y + look.px(kRow)}};
    y = row.high.y;
    return row;
  };
  const Rect head = next();
  put_text(context.ui, look.fonts.regular, look.theme.view_text,
           Rect{head.low, {head.high.x - look.px(2 * kNumber), head.high.y}}, legend.title);
  for (std::size_t column = 0; column < 2; ++column) {
    const float right = head.high.x - look.px(kNumber) * static_cast<float>(1 - column);
    put_text(context.ui, look.fonts.small, look.theme.view_text2,
             Rect{{right - look.px(kNumber), head.low.y}, {right, head.high.y}}, legend.columns[column], Align::Right);
  }
  for (const Row& row : legend.rows) draw_row(context, next(), row);
  if (!legend.note.empty()) put_text(context.ui, look.fonts.small, look.theme.view_text2, next(), legend.note);
  return true;
}

// Draws the legend of the difference. The legend always has four lines, so that its size stays the same while the
// pointer moves.
bool draw_difference(Context& context, const Rect& view) {
  const ComparedVolumes* made = compared_volumes(context);
  const Comparison& comparison = context.comparison;
  Legend legend{made ? "Voxels that differ" : "Comparing...", {"only here", "other tissue"}, {}, ""};
  for (const bool a : {true, false}) {
    Row row{a ? "A" : "B", name_of_side(context.document(), a ? comparison.a : comparison.b), std::nullopt,
            std::array{marks_of(a).air, marks_of(a).tissue}};
    if (made) row.counts = {made->side(a).differing.total.air, made->side(a).differing.total.other_tissue};
    legend.rows.push_back(row);
  }
  const Hover& hover = context.views->hover;
  const Tissue* tissue = made && hover.inside ? made->tissues->find(hover.label) : nullptr;
  if (!tissue) legend.note = "Point at a tissue to count its voxels";
  if (tissue) {
    std::array<std::int64_t, 2> both{};
    for (const bool a : {true, false})
      if (const auto found = made->side(a).differing.counts.find(hover.label);
          found != made->side(a).differing.counts.end()) {
        both[0] += found->second.air;
        both[1] += found->second.other_tissue;
      }
    legend.rows.push_back({"", shown_name(*tissue) + ", A and B", both, std::nullopt});
  }
  return draw_legend(context, view, legend);
}

bool draw_overlap(Context& context, const Rect& view) {
  Legend legend{"Voxels that overlap", {"any tissue", "two bones"}, {}, ""};
  const auto add = [&](const char* letter, const std::shared_ptr<const Result>& result, const std::string& name) {
    if (result && result->overlap)
      legend.rows.push_back({letter, name,
                             std::array{std::ssize(result->overlap->tissue) + std::int64_t{0},
                                        std::ssize(result->overlap->bones) + std::int64_t{0}},
                             std::array{mark_of_overlap(false), mark_of_overlap(true)}});
    else legend.rows.push_back({letter, result ? name + ": not stored" : name + ": none", std::nullopt, std::nullopt});
  };
  const auto shown = shown_result(context);
  if (comparing(context))
    add("A", result_named(context.document(), context.comparison->a),
        name_of_side(context.document(), context.comparison->a));
  add(comparing(context) ? "B" : "", shown, shown ? shown->name : "At rest");
  return draw_legend(context, view, legend);
}

}  // namespace

float draw_marks_legend(Context& context, const Rect& view) {
  if (shows_difference(context)) return draw_difference(context, view) ? 104 : 0;
  if (shows_overlap(context)) return draw_overlap(context, view) ? (comparing(context) ? 82 : 60) : 0;
  return 0;
}

}  // namespace limber::editor
