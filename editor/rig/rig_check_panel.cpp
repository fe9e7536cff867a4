// SPDX-License-Identifier: AGPL-3.0-or-later
// Panel of the rig check: the share of the total bone length that lies in tissue, and a list of the bones that lie
// partly outside. A click on a bone of the list centres the views on it.
#include <cmath>
#include <cstdio>

#include "editor/context/context.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/selection.h"
#include "editor/context/transform_settings.h"
#include "editor/rig/rig_check.h"
#include "editor/ui/icons.h"
#include "editor/ui/list_navigation.h"

namespace limber::editor {

namespace {

constexpr char kList[] = "rig check";

// Returns the share as text in percent. It is rounded down, so that only a share of 1 reads "100.0 %".
std::string per_cent(double share) {
  char text[16];
  std::snprintf(text, sizeof text, "%.1f %%", std::floor(share * 1000) / 10);
  return text;
}

std::string outside_text(const LeavingBone& bone) {
  return bone.head && bone.tail ? "both ends" : bone.tail ? "tail" : bone.head ? "head" : "";
}

void draw_row(Context& context, Column& column, int index, const LeavingBone& leaving, const std::string& name) {
  const Look& look = context.ui->look;
  Rect rect;
  const bool chosen = context.selection->bone == leaving.bone;
  if (!column.list_row(rect, index, chosen, kList)) return;
  const PathScope path(context.ui, name);
  const Pressed pressed = press_area(context.ui, "name", rect);
  const float number = look.px(58), bar = look.px(36),
              words = text_size(look.fonts.small, outside_text(leaving)).x + look.px(12),
              end = rect.high.x - look.px(10);
  put_text(context.ui, look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(14), rect.low.y}, {end - number - bar - words, rect.high.y}}, name);
  put_text(context.ui, look.fonts.small, look.theme.error,
           Rect{{end - number - bar - words, rect.low.y}, {end - number - bar - look.px(8), rect.high.y}},
           outside_text(leaving), Align::Right);
  const Rect field{{end - number - bar, rect.centre().y - look.px(3)}, {end - number, rect.centre().y + look.px(3)}};
  fill(field, look.theme.error, look.px(3));
  fill({field.low, {field.low.x + field.width() * static_cast<float>(leaving.share), field.high.y}}, look.theme.text3,
       look.px(3));
  put_text(context.ui, look.fonts.mono, chosen ? look.theme.text : look.theme.text2,
           Rect{{end - number, rect.low.y}, {end, rect.high.y}}, per_cent(leaving.share), Align::Right);
  if (pressed.hovered)
    tooltip(context.ui, rect, name,
            per_cent(leaving.share) + " of its length in tissue" +
                (leaving.head || leaving.tail ? "; outside: " + outside_text(leaving) : "") + ". Click to show it.");
  if (!pressed.clicked) return;
  focus_list(context.ui, kList, index);
  show_leaving(context, leaving);
}

}  // namespace

void draw_fit_check(Context& context, Column& column) {
  const KnownRigCheck* found = rig_check(context);
  if (!found) return;
  const KnownRigCheck known = *found;  // a copy, because a click on a row changes the selection
  const std::vector<LeavingBone>& rows = known.bones;
  const Look& look = context.ui->look;
  const std::string count = std::to_string(rows.size()) + (rows.size() == 1 ? " bone outside" : " bones outside");
  if (column.begin_section("Fit check", rows.empty() ? "All in tissue" : count, false)) {
    const Rect rect = column.row(32);
    const Rect words{{rect.low.x + look.px(14), rect.low.y}, {rect.high.x - look.px(130), rect.high.y}};
    put_icon(look.fonts.regular, rows.empty() ? look.theme.ok : look.theme.warn,
             Rect{words.low, {words.low.x + look.px(18), words.high.y}}, rows.empty() ? icon::kOk : icon::kWarning);
    put_text(context.ui, look.fonts.regular, look.theme.text,
             Rect{{words.low.x + look.px(24), words.low.y}, words.high}, per_cent(known.check.whole) + " in tissue");
    const float width = look.px(54), y = rect.low.y + look.px(4);
    operator_button(context, "rig.next_leaving",
                    {{rect.high.x - look.px(10) - width, y}, {rect.high.x - look.px(10), y + look.px(24)}}, "Next");
    operator_button(context, "view.rig_check",
                    {{rect.high.x - look.px(16) - 2 * width, y}, {rect.high.x - look.px(16) - width, y + look.px(24)}},
                    "Mark", context.transform_settings->rig_check_marks ? ButtonStyle::Soft : ButtonStyle::Plain);
    const ListKey key = list_key(context.ui, kList, static_cast<int>(rows.size()));
    if (!rows.empty() && (key == ListKey::Moved || key == ListKey::Activate))
      show_leaving(context, rows[context.ui->list_focus.row]);
    for (int i = 0; i < std::ssize(rows); ++i)
      draw_row(context, column, i, rows[i], known.rig->bones[rows[i].bone].name);
    if (!rows.empty()) column.space(4);
  }
  column.end_section();
}

}  // namespace limber::editor
