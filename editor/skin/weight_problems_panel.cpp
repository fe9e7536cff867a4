// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the list of weight problems by kind, with counts. A click on a row selects the problem and moves the views to
// it; the row's button repairs it.
#include "core/study/text.h"
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/skin/weight_problems.h"

#include <algorithm>

#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/ui/icons.h"
#include "editor/ui/list_navigation.h"

namespace limber::editor {

namespace {

constexpr char kList[] = "problems";
constexpr int kMostRows = 8;  // number of rows of the list that are visible without scrolling
constexpr float kRow = 24, kButton = 62, kCount = 36;

void draw_kind(Ui& ui, Column& column, WeightProblem::Kind kind, std::size_t count) {
  const Look& look = ui.look;
  const Rect rect = column.row(kRow);
  put_text(ui, look.fonts.small, look.theme.text2,
           Rect{{rect.low.x + look.px(10), rect.low.y}, {rect.high.x - look.px(50), rect.high.y}}, name_of(kind));
  put_text(ui, look.fonts.small, look.theme.text2,
           Rect{{rect.high.x - look.px(50), rect.low.y}, {rect.high.x - look.px(10), rect.high.y}},
           grouped(static_cast<std::int64_t>(count)), Align::Right);
}

// Returns the text of a problem's row: the names of the problem's bones, such as "Humerus, Forearm". The heading above
// the row names the kind of problem, and the row's tooltip describes it in full.
std::string bones_of(const WeightProblem& problem, const Armature& armature) {
  std::string names;
  for (const int bone : {problem.bone, problem.other})
    if (bone >= 0) names += (names.empty() ? "" : ", ") + armature.bones[bone].name;
  return names;
}

void draw_problem(Context& context, Column& column, const FoundProblems& found, int index) {
  const Look& look = context.ui->look;
  Rect rect;
  const bool chosen = context.skin->painting->problem == index,
             repaired = found.repaired[static_cast<std::size_t>(index)];
  if (!column.list_row(rect, index, chosen, kList)) return;
  const PathScope path(context.ui, "problem " + std::to_string(index));
  const WeightProblem& problem = found.problems[static_cast<std::size_t>(index)];
  const std::string words = describe(problem, *found.armature);
  const Rect icon{{rect.low.x + look.px(8), rect.low.y}, {rect.low.x + look.px(26), rect.high.y}},
      name{{rect.low.x, rect.low.y}, {rect.high.x - look.px(kButton + 14), rect.high.y}};
  const Pressed pressed = press_area(context.ui, "name", name);
  put_icon(look.fonts.regular, repaired ? look.theme.ok : look.theme.warn, icon, repaired ? icon::kOk : icon::kWarning);
  const Rect count{{icon.high.x, rect.low.y}, {icon.high.x + look.px(kCount), rect.high.y}};
  put_text(context.ui, look.fonts.small, look.theme.text2, count, grouped(std::ssize(problem.voxels)), Align::Right);
  put_text(context.ui, look.fonts.regular, repaired ? look.theme.text2 : look.theme.text,
           Rect{{count.high.x + look.px(6), name.low.y}, name.high}, bones_of(problem, *found.armature));
  if (pressed.hovered) tooltip(context.ui, name, words, "Click to select this problem and move the views to it.");
  const Rect press{{rect.high.x - look.px(kButton + 8), rect.low.y + look.px(2)},
                   {rect.high.x - look.px(8), rect.high.y - look.px(2)}};
  if (!repaired && button(context.ui, "Repair", press, {"", "Repair"})) {
    go_to_problem(context, index);
    run(context, "skin.repair_problem");
  } else if (pressed.clicked) {
    focus_list(context.ui, kList, index);
    go_to_problem(context, index);
  }
}

void draw_rows(Context& context, Column& column, const FoundProblems& found) {
  for (std::size_t i = 0; i < found.problems.size(); ++i) {
    const auto kind = found.problems[i].kind;
    if (i == 0 || found.problems[i - 1].kind != kind)
      draw_kind(context.ui, column, kind,
                static_cast<std::size_t>(std::count_if(found.problems.begin(), found.problems.end(),
                                                       [&](const WeightProblem& p) { return p.kind == kind; })));
    draw_problem(context, column, found, static_cast<int>(i));
  }
}

int kinds(const FoundProblems& found) {
  int count = 0;
  for (std::size_t i = 0; i < found.problems.size(); ++i)
    count += i == 0 || found.problems[i - 1].kind != found.problems[i].kind;
  return count;
}

void draw_foot(Context& context, Column& column, bool stale) {
  const Look& look = context.ui->look;
  const Rect rect = column.row(38);
  const float y = rect.low.y + look.px(6);
  float x = rect.low.x + look.px(10);
  for (const auto& [id, label] :
       {std::pair("skin.find_problems", "Find again"), std::pair("skin.next_problem", "Next")}) {
    const float width = width_of_button(context.ui, {find_operator(context.operators, id)->icon, label});
    operator_button(context, id, {{x, y}, {x + width, y + look.px(26)}}, label);
    x += width + look.px(6);
  }
  if (!stale) return;
  put_icon(look.fonts.regular, look.theme.warn, {{x, y}, {x + look.px(20), y + look.px(26)}}, icon::kWaiting);
  put_text(context.ui, look.fonts.small, look.theme.warn,
           Rect{{x + look.px(22), y}, {rect.high.x - look.px(8), y + look.px(26)}}, "Out of date");
}

}  // namespace

void draw_weight_problems(Context& context, Column& column) {
  const auto found = context.skin->painting->problems;  // a copy, because a repair may replace the list
  const bool stale = problems_stale(context);
  const auto left = found ? std::count(found->repaired.begin(), found->repaired.end(), false) : 0;
  if (column.begin_section("Problems",
                           !found      ? ""
                           : stale     ? "stale"
                           : left == 0 ? "None"
                                       : std::to_string(left),
                           false)) {
    if (!found) {
      if (empty_state(context.ui, column.row(72),
                      finds_problems(context.jobs) ? "Searching for problems" : "Not searched yet",
                      find_operator(context.operators, "skin.find_problems")->label))
        run(context, "skin.find_problems");
    } else {
      const ListKey key = list_key(context.ui, kList, static_cast<int>(found->problems.size()));
      if (!found->problems.empty() && (key == ListKey::Moved || key == ListKey::Activate))
        go_to_problem(context, context.ui->list_focus.row);
      const int rows = static_cast<int>(found->problems.size()) + kinds(*found);
      if (rows <= kMostRows) {
        draw_rows(context, column, *found);
      } else {
        Column list(context.ui, "list", column.row(kRow * kMostRows));
        draw_rows(context, list, *found);
      }
      draw_foot(context, column, stale);
    }
  }
  column.end_section();
}

}  // namespace limber::editor
