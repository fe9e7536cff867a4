// SPDX-License-Identifier: AGPL-3.0-or-later
// Charts as inline SVG: labelled directly, one colour and one mark per technique everywhere; made mass-exact, it has
// the same ones, hollow, and a dashed line. Colours are the page's: classes tN of technique N and `exact`, `axis`,
// `grid`, `muted` (page_style.cpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/study/study.h"

namespace limber {

struct Series {
  std::string name;
  TechniqueLook look;                         // its colour and mark
  std::vector<std::optional<double>> values;  // one per place on the x axis; none: not measured
};

struct LineChart {
  std::string title, unit;          // of the y axis: "%", "s"
  std::vector<std::string> places;  // along x
  std::vector<double> positions;    // of the places; empty: evenly spaced
  std::string x_unit;
  std::vector<Series> series;
  std::optional<double> low, high;  // of the y axis; none: as the values need
  bool is_signed = false;           // values are changes: the axis carries signs and a line at 0
  bool logarithmic = false;
  bool names = true;  // at the lines' ends
  int width = 620, height = 320;
};
std::string svg_of(const LineChart& chart);

// Bars that start at 0, in groups; `decimals` of the figure over each. Wider than asked where the bars need it.
struct BarChart {
  std::string unit;
  std::vector<std::string> places;  // of a group's bars
  std::vector<Series> groups;
  int decimals = 0;
  int width = 620, height = 300;
};
std::string svg_of(const BarChart& chart);

// The mark of a technique, for legends: 12 by 12.
std::string mark_svg(const TechniqueLook& look);

}  // namespace limber
