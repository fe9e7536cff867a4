// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws a bar chart beside the table of results: each tissue's volume change in percent, for both results of the
// comparison or for the shown result.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "editor/context/comparison.h"
#include "editor/context/context.h"
#include "editor/context/panels.h"
#include "editor/resample/results.h"
#include "editor/volume/tissue_edits.h"
#include "editor/volume/volume_change.h"

namespace limber::editor {

namespace {

constexpr float kHead = 26, kAxis = 20, kPad = 12, kName = 112, kFigure = 58;
// Smallest range of the chart's axis, percent. With a smaller range, small changes would look large.
constexpr double kLeastSpan = 2;

struct Series {
  std::string letter, method;
  std::shared_ptr<const ResultFacts> facts;
  Colour colour;
};

std::vector<Series> series_of(Context& context) {
  std::vector<Series> all;
  const auto add = [&](const std::string& letter, const std::shared_ptr<const Result>& result) {
    if (result)
      all.push_back(
          {letter, method_name(result->method), facts_of(context, result), letter == "A" ? kColourOfA : kColourOfB});
  };
  const Comparison& comparison = context.comparison;
  const auto a = result_named(context.document(), comparison.a), b = result_named(context.document(), comparison.b);
  if (a != b) add("A", a), add("B", b);
  if (all.empty()) add("", chosen_result(context));
  return all;
}

const ResultTissue* find(const ResultFacts& facts, const std::string& name) {
  const auto found = std::find_if(facts.tissues.begin(), facts.tissues.end(),
                                  [&](const ResultTissue& tissue) { return tissue.name == name; });
  return found == facts.tissues.end() ? nullptr : &*found;
}

// The chart's axis, percent: it runs from `low` to `high` and has a line at each multiple of `step`.
struct Axis {
  double low = 0, high = 0, step = 1;
  double place(double percent) const { return (std::clamp(percent, low, high) - low) / (high - low); }
};

Axis axis_of(const std::vector<Series>& all) {
  Axis axis;
  for (const Series& one : all)
    for (const ResultTissue& tissue : one.facts->tissues) {
      axis.low = std::min(axis.low, tissue.change_percent.value_or(0));
      axis.high = std::max(axis.high, tissue.change_percent.value_or(0));
    }
  if (const double lacking = kLeastSpan - (axis.high - axis.low); lacking > 0)
    axis.low -= lacking / 2, axis.high += lacking / 2;
  const double rough = (axis.high - axis.low) / 3, power = std::pow(10.0, std::floor(std::log10(rough)));
  axis.step = power * (rough < 1.5 * power ? 1 : rough < 3.5 * power ? 2 : rough < 7.5 * power ? 5 : 10);
  axis.low = std::floor(axis.low / axis.step + 1e-9) * axis.step;
  axis.high = std::ceil(axis.high / axis.step - 1e-9) * axis.step;
  return axis;
}

void draw_lines(const Look& look, const Axis& axis, float left, float width, const Rect& row) {
  for (double at = axis.low; at < axis.high + axis.step / 2; at += axis.step) {
    const float x = std::round(left + width * static_cast<float>(axis.place(at)));
    fill({{x, row.low.y}, {x + look.line(), row.high.y}},
         std::abs(at) < axis.step / 2 ? look.theme.text2 : look.theme.line2);
  }
}

// Returns a change in percent as text, "+0.12". The text has no unit, because the chart's title names it.
std::string figure(const std::optional<double>& percent) {
  if (!percent) return "-";
  if (std::abs(*percent) < 99.95) return figure_of_change(*percent);
  char text[24];
  std::snprintf(text, sizeof text, "%+.0f", *percent);
  return text;
}

void draw_tissue(Context& context, const Rect& row, const std::string& name, const std::vector<Series>& all,
                 const Axis& axis, float left, float width) {
  const Look& look = context.ui->look;
  put_text(context.ui, look.fonts.regular, look.theme.text2,
           Rect{{row.low.x + look.px(kPad), row.low.y}, {left - look.px(8), row.high.y}}, capitalized(name));
  draw_lines(look, axis, left, width, row);
  const float count = static_cast<float>(all.size()), high = look.px(7),
              zero = std::round(left + width * static_cast<float>(axis.place(0)));
  float y = std::round(row.centre().y - (high * count + look.px(1) * (count - 1)) / 2), x = left + width + look.px(4);
  std::string whole;
  for (const Series& one : all) {
    const ResultTissue* tissue = find(*one.facts, name);
    const std::optional<double> percent = tissue ? tissue->change_percent : std::nullopt;
    const float end = std::round(left + width * static_cast<float>(axis.place(percent.value_or(0))));
    if (end != zero) fill({{std::min(zero, end), y}, {std::max(zero, end) + look.line(), y + high}}, one.colour);
    put_text(context.ui, look.fonts.mono, colour_of_change(look.theme, percent),
             Rect{{x, row.low.y}, {x + look.px(kFigure), row.high.y}}, figure(percent), Align::Right);
    y += high + look.px(1);
    x += look.px(kFigure + 4);
    char words[96];
    if (tissue)
      std::snprintf(words, sizeof words, "%s%.1f to %.1f cm\u00b3",
                    one.letter.empty() ? "" : (one.letter + ": ").c_str(), tissue->mm3_before / 1000,
                    tissue->mm3_after / 1000);
    if (tissue) whole += (whole.empty() ? "" : "\n") + std::string(words);
  }
  const PathScope path(context.ui, name);
  if (press_area(context.ui, "row", row).hovered) tooltip(context.ui, row, capitalized(name), whole);
}

}  // namespace

void draw_change_plot(Context& context, const Rect& rect) {
  const std::vector<Series> all = series_of(context);
  if (all.empty()) return;
  const Look& look = context.ui->look;
  const PathScope path(context.ui, "change");
  const Axis axis = axis_of(all);
  const Rect head{rect.low, {rect.high.x, rect.low.y + look.px(kHead)}},
      foot{{rect.low.x, rect.high.y - look.px(kAxis)}, rect.high};
  const char* title = "Volume change, %";
  put_text(context.ui, look.fonts.semibold, look.theme.text, Rect{{head.low.x + look.px(kPad), head.low.y}, head.high},
           title);
  float right = head.high.x - look.px(kPad);
  const float title_end = head.low.x + look.px(kPad + 12) + text_size(look.fonts.semibold, title).x;
  for (auto one = all.rbegin(); one != all.rend(); ++one) {
    const std::string words = one->letter.empty() ? one->method : one->letter + " " + one->method;
    const float width = std::min(text_size(look.fonts.regular, words).x + 1,
                                 (right - title_end) / (one == all.rbegin() ? float(all.size()) : 1.0f) - look.px(22));
    put_text(context.ui, look.fonts.regular, look.theme.text2, Rect{{right - width, head.low.y}, {right, head.high.y}},
             words);
    put_swatch(look, {right - width - look.px(20), head.centre().y - look.px(7)}, one->colour);
    right -= width + look.px(32);
  }

  const float left = rect.low.x + look.px(kPad + kName),
              width = rect.high.x - look.px(kPad + 14) - look.px(kFigure + 4) * static_cast<float>(all.size()) - left;
  {
    Column column(context.ui, "tissues", {{rect.low.x, head.high.y}, {rect.high.x, foot.low.y}});
    int index = 0;
    std::vector<std::string> names;
    for (const Series& one : all)
      for (const ResultTissue& tissue : one.facts->tissues)
        if (std::find(names.begin(), names.end(), tissue.name) == names.end()) names.push_back(tissue.name);
    for (const std::string& name : names) {
      Rect row;
      if (column.list_row(row, index++, false)) draw_tissue(context, row, name, all, axis, left, width);
    }
  }
  fill({{left, foot.low.y}, {left + width, foot.low.y + look.line()}}, look.theme.line2);
  for (double at = axis.low; at < axis.high + axis.step / 2; at += axis.step) {
    const float x = left + width * static_cast<float>(axis.place(at)), half = look.px(24);
    char text[16];
    std::snprintf(text, sizeof text, "%g", std::abs(at) < axis.step / 2 ? 0 : std::round(at * 1e6) / 1e6);
    put_text(context.ui, look.fonts.small, look.theme.text2, Rect{{x - half, foot.low.y}, {x + half, foot.high.y}},
             text, Align::Centre);
  }
}

}  // namespace limber::editor
