// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws charts as inline SVG, with labels at the lines instead of a legend. A technique has the same colour and mark in
// every chart. Its mass-exact variant (masses corrected afterwards) has a hollow mark and a dashed line. Colours come
// from the CSS classes of the page (page_style.cpp): tN for the technique with colour and mark number N, `exact`,
// `axis`, `grid` and `muted`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/study/study.h"

namespace limber {

struct Series {
  std::string name;
  TechniqueLook look;                         // colour and mark of the series
  std::vector<std::optional<double>> values;  // one value for each label on the x axis; empty: not measured
};

struct LineChart {
  std::string title, unit;          // title of the chart; unit of its y axis: "%", "s"
  std::vector<std::string> places;  // the labels along the x axis
  std::vector<double> positions;    // x value of each label in `places`; empty: the labels are evenly spaced
  std::string x_unit;
  std::vector<Series> series;
  std::optional<double> low, high;  // bounds of the y axis; empty: computed from the values
  bool is_signed = false;           // true: values are changes, so their signs and a line at 0 are shown
  bool logarithmic = false;
  bool names = true;  // true: each line has the name of its series at its right end
  int width = 620, height = 320;
};
std::string svg_of(const LineChart& chart);

// A chart of grouped bars that start at 0, with the value above each bar. The chart becomes wider than `width` if the
// bars need it.
struct BarChart {
  std::string unit;
  std::vector<std::string> places;  // the labels of the bars within a group
  std::vector<Series> groups;
  int decimals = 0;
  int width = 620, height = 300;
};
std::string svg_of(const BarChart& chart);

// Returns the mark of a technique for legends, as an SVG of 12 by 12 px.
std::string mark_svg(const TechniqueLook& look);

}  // namespace limber
