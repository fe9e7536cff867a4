// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/charts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <sstream>

#include "core/study/study.h"
#include "core/study/text.h"

namespace limber {

namespace {

constexpr double kLetter = 6.2;     // approximate width of a letter in text of 11 px, px
constexpr double kLineHeight = 14;  // baselines of labels are at least this far apart, px
// Width of a bar, so that its value fits above it, and largest width of a chart, px.
constexpr int kBar = 22, kWidest = 940;

std::string px(double value) { return fixed(value, 1); }

std::string label(double x, double y, const std::string& text, const std::string& style = "",
                  const char* anchor = "start") {
  return "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" text-anchor=\"" + anchor + "\"" +
         (style.empty() ? "" : " class=\"" + style + "\"") + ">" + escaped(text) + "</text>";
}
std::string line(double x1, double y1, double x2, double y2, const char* style) {
  return "<line x1=\"" + px(x1) + "\" y1=\"" + px(y1) + "\" x2=\"" + px(x2) + "\" y2=\"" + px(y2) + "\" class=\"" +
         style + "\"/>";
}
std::string colour_of(const TechniqueLook& look) {
  if (look.number < 0) return "t-none";
  return "t" + std::to_string(look.number) + (look.exact ? " exact" : "");
}

// Draws the mark of a technique: a circle, square, triangle, diamond or inverted triangle. For a value that belongs to
// no technique, draws a small dot.
std::string mark(const TechniqueLook& look, double x, double y, double r) {
  const std::string style = " class=\"mark " + colour_of(look) + "\"/>";
  switch (look.number) {
    case 1:
      return "<rect x=\"" + px(x - 0.88 * r) + "\" y=\"" + px(y - 0.88 * r) + "\" width=\"" + px(1.76 * r) +
             "\" height=\"" + px(1.76 * r) + "\"" + style;
    case 2:
      return "<path d=\"M" + px(x) + " " + px(y - 1.15 * r) + "L" + px(x + 1.1 * r) + " " + px(y + 0.85 * r) + "L" +
             px(x - 1.1 * r) + " " + px(y + 0.85 * r) + "Z\"" + style;
    case 3:
      return "<path d=\"M" + px(x) + " " + px(y - 1.25 * r) + "L" + px(x + 1.25 * r) + " " + px(y) + "L" + px(x) + " " +
             px(y + 1.25 * r) + "L" + px(x - 1.25 * r) + " " + px(y) + "Z\"" + style;
    case 4:
      return "<path d=\"M" + px(x) + " " + px(y + 1.15 * r) + "L" + px(x + 1.1 * r) + " " + px(y - 0.85 * r) + "L" +
             px(x - 1.1 * r) + " " + px(y - 0.85 * r) + "Z\"" + style;
    default:
      return "<circle cx=\"" + px(x) + "\" cy=\"" + px(y) + "\" r=\"" + px(look.number < 0 ? 0.7 * r : r) + "\"" +
             style;
  }
}

std::string begin(int width, int height, const std::string& what) {
  return "<svg viewBox=\"0 0 " + std::to_string(width) + " " + std::to_string(height) +
         "\" role=\"img\" aria-label=\"" + escaped(what) + "\" style=\"max-width:" + std::to_string(width) + "px\">";
}

// Returns the distance between the ticks of an axis. It is 1, 2 or 5 times a power of ten, and divides the axis's range
// into at most `most` parts.
double tick_step(double range, int most) {
  const double rough = range / most, power = std::pow(10, std::floor(std::log10(rough)));
  for (const double nice : {1.0, 2.0, 5.0})
    if (nice * power >= rough * 0.999) return nice * power;
  return 10 * power;
}
int decimals_of(double step) { return std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9))); }

// Wraps the text into lines of at most `width` px. Words are not cut, so a long word may exceed the width.
std::vector<std::string> wrapped(const std::string& text, double width) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!lines.empty() && kLetter * double(lines.back().size() + 1 + word.size()) <= width) lines.back() += " " + word;
    else lines.push_back(word);
  }
  return lines;
}

struct Range {
  double low = 0, high = 1;
};

Range range_of(const LineChart& chart) {
  Range range{INFINITY, -INFINITY};
  for (const Series& series : chart.series)
    for (const auto& value : series.values)
      if (value && (!chart.logarithmic || *value > 0))
        range.low = std::min(range.low, *value), range.high = std::max(range.high, *value);
  if (!(range.low <= range.high)) return {0, 1};
  if (chart.logarithmic)
    return {std::pow(10, std::floor(std::log10(range.low))), std::pow(10, std::ceil(std::log10(range.high) + 1e-9))};
  range.low = std::min(range.low, 0.0);
  range.high = std::max(range.high, 0.0);
  if (range.high - range.low < 1e-9) range.high = range.low + 1;
  const double step = tick_step(range.high - range.low, 5);
  range.low = step * std::floor(range.low / step + 1e-9);
  range.high = step * std::ceil(range.high / step - 1e-9);
  return range;
}

// Moves overlapping labels apart vertically without changing their order. They are the labels at the right ends of a
// chart's lines. Takes the wanted y coordinates and returns the new ones.
std::vector<double> spread(std::vector<double> wanted, double low, double high) {
  std::vector<std::size_t> order(wanted.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return wanted[a] < wanted[b]; });
  for (int pass = 0; pass < 200; ++pass)
    for (std::size_t i = 1; i < order.size(); ++i) {
      double &above = wanted[order[i - 1]], &below = wanted[order[i]];
      if (const double lacks = kLineHeight - (below - above); lacks > 0.01) above -= lacks / 2, below += lacks / 2;
      above = std::max(above, low);
      below = std::min(below, high);
    }
  return wanted;
}

}  // namespace

std::string mark_svg(const TechniqueLook& look) {
  return "<svg class=\"legend\" viewBox=\"0 0 12 12\" width=\"12\" height=\"12\" aria-hidden=\"true\">" +
         mark(look, 6, 6, 4.2) + "</svg>";
}

std::string svg_of(const LineChart& chart) {
  std::size_t longest = 0;
  for (const Series& series : chart.series) longest = std::max(longest, series.name.size());
  const double left = 48, right = chart.width - (chart.names ? 14 + kLetter * double(longest) : 12),
               top = chart.title.empty() ? 28 : 46, bottom = chart.height - 30;
  Range range = range_of(chart);
  if (chart.low) range.low = *chart.low;
  if (chart.high) range.high = *chart.high;
  const auto y_of = [&](double value) {
    const double share = chart.logarithmic
                             ? std::log(std::max(value, range.low) / range.low) / std::log(range.high / range.low)
                             : (value - range.low) / (range.high - range.low);
    return bottom - share * (bottom - top);
  };
  const auto places = static_cast<double>(chart.places.size());
  const auto x_of = [&](std::size_t place) {
    if (chart.positions.empty())
      return places < 2 ? (left + right) / 2 : left + 14 + (right - left - 28) * double(place) / (places - 1);
    const auto [low, high] = std::minmax_element(chart.positions.begin(), chart.positions.end());
    return *high > *low ? left + 14 + (right - left - 28) * (chart.positions[place] - *low) / (*high - *low)
                        : (left + right) / 2;
  };

  std::string svg = begin(chart.width, chart.height, chart.title.empty() ? "Line chart" : chart.title);
  if (!chart.title.empty()) svg += label(2, 14, chart.title, "title");
  svg += label(2, top - 14, chart.unit, "muted");
  if (chart.logarithmic) {
    for (double tick = range.low; tick <= range.high * 1.001; tick *= 10)
      svg += line(left, y_of(tick), right, y_of(tick), "grid") +
             label(left - 6, y_of(tick) + 4, number(tick), "tick", "end");
  } else {
    // There are at most 7 parts between ticks: range_of() aims at 5 parts, and its rounding adds at most one part at
    // each end.
    const double step = tick_step(range.high - range.low, 7);
    for (int i = 0; range.low + i * step <= range.high + step * 1e-6; ++i) {
      const double tick = range.low + i * step;
      const bool is_zero = std::abs(tick) < step * 1e-6;
      svg += line(left, y_of(tick), right, y_of(tick), is_zero ? "axis" : "grid");
      svg +=
          label(left - 6, y_of(tick) + 4,
                chart.is_signed ? signed_number(is_zero ? 0 : tick, decimals_of(step)) : fixed(tick, decimals_of(step)),
                "tick", "end");
    }
  }
  const double room = places > 1 ? (right - left - 28) / (places - 1) : right - left;
  double written_to = -INFINITY;
  for (std::size_t place = 0; place < chart.places.size(); ++place) {
    const double half = kLetter * double(chart.places[place].size()) / 2;
    // Leaves out a label that would overlap the label before it.
    if (x_of(place) - half < written_to && room < 2 * half) continue;
    written_to = x_of(place) + half + 4;
    svg += label(x_of(place), bottom + 17, chart.places[place], "tick", "middle");
  }
  if (!chart.x_unit.empty()) svg += label(right, bottom + 28, chart.x_unit, "muted", "end");

  std::vector<double> ends;
  std::vector<const Series*> named;
  for (const Series& series : chart.series) {
    std::string path, marks;
    std::optional<double> end;
    bool open = false;
    for (std::size_t place = 0; place < series.values.size() && place < chart.places.size(); ++place) {
      if (!series.values[place]) {
        open = false;
        continue;
      }
      const double x = x_of(place), y = y_of(std::clamp(*series.values[place], range.low, range.high));
      path += (open ? "L" : "M") + px(x) + " " + px(y);
      open = true;
      marks += mark(series.look, x, y, 3.6);
      end = y;
    }
    if (!end) continue;
    svg += "<path d=\"" + path + "\" class=\"line " + colour_of(series.look) + "\"/>" + marks;
    ends.push_back(*end);
    named.push_back(&series);
  }
  if (chart.names) {
    const std::vector<double> at = spread(ends, top, bottom + 4);
    for (std::size_t i = 0; i < named.size(); ++i)
      svg += label(right + 6, at[i] + 4, named[i]->name, "name " + colour_of(named[i]->look));
  }
  return svg + "</svg>";
}

std::string svg_of(const BarChart& chart) {
  const auto groups = std::max<std::size_t>(1, chart.groups.size());
  const int width =
      std::max(chart.width, std::min(kWidest, static_cast<int>(64 + groups * (20 + kBar * chart.places.size()))));
  const double left = 48, right = width - 8, group_width = (right - left) / double(groups);
  std::vector<std::vector<std::string>> names;
  std::size_t lines = 1;
  for (const Series& group : chart.groups)
    lines = std::max(lines, names.emplace_back(wrapped(group.name, group_width - 6)).size());
  const int height = chart.height + static_cast<int>(kLineHeight * double(lines - 1));
  const double top = 28, bottom = chart.height - 46;
  double most = 0;
  for (const Series& group : chart.groups)
    for (const auto& value : group.values)
      if (value) most = std::max(most, *value);
  if (most <= 0) most = 1;
  const double step = tick_step(most, 5), high = step * std::ceil(most * 1.04 / step);
  const auto y_of = [&](double value) { return bottom - value / high * (bottom - top); };

  std::string svg = begin(width, height, "Bar chart");
  svg += label(2, top - 14, chart.unit, "muted");
  for (int i = 0; i * step <= high + step * 1e-6; ++i)
    svg += line(left, y_of(i * step), right, y_of(i * step), i ? "grid" : "axis") +
           label(left - 6, y_of(i * step) + 4, fixed(i * step, decimals_of(step)), "tick", "end");
  for (std::size_t g = 0; g < chart.groups.size(); ++g) {
    const Series& group = chart.groups[g];
    const double begin_x = left + group_width * double(g) + 10,
                 slot = (group_width - 20) / std::max<double>(1, double(chart.places.size()));
    for (std::size_t place = 0; place < group.values.size(); ++place) {
      const double x = begin_x + slot * double(place), wide = std::min(slot * 0.78, 46.0), middle = x + slot / 2;
      if (slot >= 16) svg += label(middle, bottom + 15, chart.places[place], "tick", "middle");
      if (!group.values[place]) continue;
      const double y = y_of(*group.values[place]);
      svg += "<rect x=\"" + px(middle - wide / 2) + "\" y=\"" + px(y) + "\" width=\"" + px(wide) + "\" height=\"" +
             px(bottom - y) + "\" class=\"bar " + colour_of(group.look) + "\"/>";
      if (slot >= 22) svg += label(middle, y - 4, fixed(*group.values[place], chart.decimals), "figure", "middle");
    }
    for (std::size_t i = 0; i < names[g].size(); ++i)
      svg += label(left + group_width * (double(g) + 0.5), bottom + 36 + kLineHeight * double(i), names[g][i],
                   "name " + colour_of(group.look), "middle");
  }
  return svg + "</svg>";
}

}  // namespace limber
