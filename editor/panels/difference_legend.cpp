// SPDX-License-Identifier: AGPL-3.0-or-later
// Over a view that marks where two volumes differ: how many voxels of either side have nothing, or another tissue, on the other
// one, in all and of the tissue under the pointer.
#include <algorithm>

#include "editor/difference.h"
#include "editor/panels/panels.h"
#include "editor/prepare.h"
#include "editor/results.h"
#include "editor/tissues.h"

namespace limber::editor {

namespace {

constexpr float kWidth = 340, kRow = 22, kPad = 10, kMargin = 8, kNumber = 92;

Colour colour(const glm::vec3& srgb) { return rgb(srgb.r, srgb.g, srgb.b); }

struct Row {
  std::string letter, name;
  const DifferingSide::Count* count = nullptr;  // null: being found
  std::optional<MarkColours> marks;
};

void draw_row(Editor& editor, const Rect& row, const Row& words) {
  const Look& look = editor.look;
  const float second = row.high.x, first = second - look.px(kNumber), left = first - look.px(kNumber);
  put_text(editor, look.fonts.semibold, look.theme.view_text, Rect{row.low, {row.low.x + look.px(18), row.high.y}}, words.letter);
  put_text(editor, look.fonts.regular, look.theme.view_text, Rect{{row.low.x + look.px(words.letter.empty() ? 0 : 18), row.low.y}, {left, row.high.y}}, words.name);
  if (!words.count) return;
  const auto number = [&](float right, std::int64_t value, const std::optional<glm::vec3>& mark) {
    const std::string digits = grouped(value);
    put_text(editor, look.fonts.mono, look.theme.view_text, Rect{{right - look.px(kNumber), row.low.y}, {right, row.high.y}}, digits, Align::Right);
    if (mark) put_swatch(look, {right - text_size(look.fonts.mono, digits).x - look.px(22), row.centre().y - look.px(7)}, colour(*mark));
  };
  number(first, words.count->air, words.marks ? std::optional(words.marks->air) : std::nullopt);
  number(second, words.count->other_tissue, words.marks ? std::optional(words.marks->tissue) : std::nullopt);
}

}  // namespace

bool draw_difference_legend(Editor& editor, const Rect& view) {
  const Look& look = editor.look;
  if (!shows_difference(editor) || view.width() < look.px(300) || view.height() < look.px(180)) return false;
  const ComparedVolumes* made = compared_volumes(editor);
  const float width = std::min(look.px(kWidth), view.width() - look.px(2 * kMargin));
  const glm::vec2 low{view.low.x + look.px(kMargin), view.high.y - look.px(kMargin + 4 * kRow + 8)};
  const Rect box{low, low + glm::vec2(width, look.px(4 * kRow + 8))};
  fill(box, with_alpha(look.theme.view_plate, 0.85f), look.px(5));
  register_widget(editor, "legend", box);
  float y = box.low.y + look.px(4);
  const auto next = [&] {
    const Rect row{{box.low.x + look.px(kPad), y}, {box.high.x - look.px(kPad), y + look.px(kRow)}};
    y = row.high.y;
    return row;
  };
  const Rect head = next();
  put_text(editor, look.fonts.regular, look.theme.view_text, Rect{head.low, {head.high.x - look.px(2 * kNumber), head.high.y}}, made ? "Voxels that differ" : "Comparing...");
  put_text(editor, look.fonts.small, look.theme.view_text2, Rect{{head.high.x - look.px(2 * kNumber), head.low.y}, {head.high.x - look.px(kNumber), head.high.y}}, "only here", Align::Right);
  put_text(editor, look.fonts.small, look.theme.view_text2, Rect{{head.high.x - look.px(kNumber), head.low.y}, head.high}, "other tissue", Align::Right);
  const Comparison& comparison = editor.comparison;
  draw_row(editor, next(), {"A", name_of_side(editor, comparison.a), made ? &made->a.differing.total : nullptr, marks_of(true)});
  draw_row(editor, next(), {"B", name_of_side(editor, comparison.b), made ? &made->b.differing.total : nullptr, marks_of(false)});
  const Hover& hover = editor.views->hover;
  const Tissue* tissue = made && hover.inside ? made->tissues->find(hover.label) : nullptr;
  if (!tissue) {
    put_text(editor, look.fonts.small, look.theme.view_text2, next(), "Point at a tissue for its own voxels");
    return true;
  }
  DifferingSide::Count both;
  for (const bool a : {true, false})
    if (const auto found = made->side(a).differing.counts.find(hover.label); found != made->side(a).differing.counts.end()) {
      both.air += found->second.air;
      both.other_tissue += found->second.other_tissue;
    }
  draw_row(editor, next(), {"", shown_name(*tissue) + ", A and B", &both, std::nullopt});
  return true;
}

}  // namespace limber::editor
