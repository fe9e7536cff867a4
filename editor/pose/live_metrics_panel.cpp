// SPDX-License-Identifier: AGPL-3.0-or-later
// Panel "Live volume": how the shown pose changes the volume of each tissue (cm^3 and percent), the overlap in voxels,
// and whether joints exceed their limits.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/pose/limit_check.h"
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/panels.h"
#include "editor/pose/live_preview.h"
#include "editor/pose/pose_edits.h"
#include "editor/ui/icons.h"
#include "editor/volume/volume_change.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

constexpr std::size_t kMostTissues = 6;  // tissues listed before the user expands the list
constexpr char kAll[] = "Live volume: all tissues";
constexpr double kBeyond = 1e-6;  // an excess over a joint limit is reported if it is larger than this, radians

Rect padded(const Ui& ui, const Rect& row) {
  const float inset = ui.look.px(10);
  return {{row.low.x + inset, row.low.y}, {row.high.x - inset, row.high.y}};
}

struct Cells {
  std::string name, volume, change;
};
void put_cells(Ui& ui, const Rect& row, const Cells& cells, const std::array<Colour, 3>& colours, ImFont* words,
               ImFont* digits, float indent) {
  const Rect inner = padded(ui, row);
  const float change = inner.high.x - ui.look.px(76), volume = change - ui.look.px(68);
  put_text(ui, words, colours[0], Rect{{inner.low.x + ui.look.px(indent), row.low.y}, {volume, row.high.y}},
           cells.name);
  put_text(ui, digits, colours[1], Rect{{volume, row.low.y}, {change, row.high.y}}, cells.volume, Align::Right);
  put_text(ui, digits, colours[2], Rect{{change, row.low.y}, inner.high}, cells.change, Align::Right);
}

// Draws a row with a tissue's volume (cm^3) and its change (percent).
//   known  whether the numbers belong to the shown pose; numbers of an earlier pose are grey
void put_change(Ui& ui, const Rect& row, const PoseMetrics::Row& tissue, ImFont* font, bool known, float indent) {
  const Look& look = ui.look;
  const auto tenths = static_cast<std::int64_t>(std::llround(tissue.mm3_after / 100));  // tenths of a cm^3
  const std::string volume = grouped(tenths / 10) + "." + std::to_string(tenths % 10);
  const Colour grey = look.theme.text3;
  put_cells(ui, row, {tissue.name, volume, percent(tissue.change_percent())},
            {look.theme.text, known ? look.theme.text2 : grey,
             known ? colour_of_change(look.theme, tissue.change_percent()) : grey},
            font, look.fonts.mono, indent);
}

// Draws a row with text on the left and numbers on the right.
void put_line(Ui& ui, Column& column, const std::string& words, const std::string& figures, Colour colour) {
  const Look& look = ui.look;
  const Rect row = padded(ui, column.row(24));
  put_text(ui, look.fonts.regular, look.theme.text2, Rect{row.low, {row.low.x + look.px(110), row.high.y}}, words);
  put_text(ui, look.fonts.regular, colour, Rect{{row.low.x + look.px(110), row.low.y}, row.high}, figures,
           Align::Right);
}

void put_metrics(Ui& ui, Column& column, const PoseMetrics& metrics, bool known) {
  const Look& look = ui.look;
  const Colour second = look.theme.text2;
  put_cells(ui, column.row(24), {"Tissue", "cm\u00b3", "change"}, {second, second, second}, look.fonts.small,
            look.fonts.small, 0);
  // Tissues that change most come first.
  std::vector<PoseMetrics::Row> tissues = metrics.tissues;
  std::stable_sort(tissues.begin(), tissues.end(), [](const auto& a, const auto& b) {
    return std::abs(a.change_percent().value_or(0)) > std::abs(b.change_percent().value_or(0));
  });
  bool& all = ui.open_sections[kAll];
  for (std::size_t i = 0; i < (all ? tissues.size() : std::min(tissues.size(), kMostTissues)); ++i) {
    const PoseMetrics::Row& tissue = tissues[i];
    Rect row;
    if (!column.list_row(row, static_cast<int>(i), false)) continue;
    const float side = look.px(14), x = row.low.x + look.px(10), y = std::round(row.centre().y - side / 2);
    const Rect swatch{{x, y}, {x + side, y + side}};
    fill(swatch, rgb(tissue.colour.r, tissue.colour.g, tissue.colour.b), look.px(3));
    outline(swatch, look.theme.line2, look.px(3), look.line());
    put_change(ui, row, tissue, look.fonts.regular, known, 22);
  }
  if (tissues.size() > kMostTissues) {
    const Rect row = padded(ui, column.row(24));
    const Pressed pressed = press_area(ui, "All tissues", row);
    const std::string words = all ? "Only the " + std::to_string(kMostTissues) + " that change most"
                                  : "All " + std::to_string(tissues.size()) + " tissues";
    put_text(ui, look.fonts.regular, pressed.hovered ? look.theme.text : look.theme.accent_text,
             Rect{{row.low.x + look.px(22), row.low.y}, row.high}, words);
    if (pressed.clicked) all = !all, ui.touch();
  }
  put_change(ui, column.row(26), metrics.total, look.fonts.semibold, known, 0);
  put_line(ui, column, "Overlap", grouped(metrics.overlap_voxels) + " voxels",
           !known                   ? look.theme.text3
           : metrics.overlap_voxels ? look.theme.warn
                                    : look.theme.ok);
}

void put_limits(Context& context, Column& column) {
  const Armature& armature = *context.document().armature;
  const LimitCheck check = check_limits(armature, shown_pose(context), kBeyond);
  const Theme& theme = context.ui->look.theme;
  put_line(context.ui, column, "Joint limits", words_of(check, armature),
           check.limited == 0 ? theme.text3
           : check.beyond     ? theme.warn
                              : theme.ok);
}

}  // namespace

void draw_live_volume(Context& context, Column& column) {
  const Look& look = context.ui->look;
  const Document& document = context.document();
  if (!document.volume || !document.armature) return;
  LivePose& live = *context.live;
  const PoseMetrics* known = live.metrics().known();
  const PoseMetrics* metrics = known ? known : live.metrics().last();
  const std::string trouble = live.trouble().empty() ? live.metrics().trouble() : live.trouble();
  const bool posed = live.posed();
  if (column.begin_section("Live volume", !trouble.empty() || !posed ? "" : known ? "dense" : "coarse")) {
    if (!document.weights) {
      const Operator* op = find_operator(context.operators, "skin.heat");
      if (empty_state(context.ui, column.row(84), trouble, op->label)) run(context, *op);
    } else if (!trouble.empty()) {
      const Rect row = padded(context.ui, column.row(28));
      put_text(context.ui, look.fonts.regular, look.theme.warn, row, trouble);
      if (ImGui::IsMouseHoveringRect(im(row.low), im(row.high)))
        tooltip(context.ui, row, "The volume does not follow the pose", trouble);
    } else {
      live.metrics().want();
      if (metrics) put_metrics(context.ui, column, *metrics, known != nullptr);
      else
        put_text(context.ui, look.fonts.regular, look.theme.text2, padded(context.ui, column.row(28)),
                 posed ? "Measured when the pose stops changing" : "At rest");
      put_limits(context, column);
    }
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
