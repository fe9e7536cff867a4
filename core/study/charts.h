// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws charts as inline SVG with direct labels. A technique has the same colour and mark in every chart; its
// mass-exact variant has a hollow mark and a dashed line. The colours are CSS classes of the page (page_style.cpp): tN
// for the technique with look N, `exact`, `axis`, `grid` and `muted`.
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
  std::string title, unit;          // unit of the y axis: "%", "s"
  std::vector<std::string> places;  // the labels along the x axis
  std::vector<double> positions;    // x values of these labels; empty: evenly spaced
  std::string x_unit;
  std::vector<Series> series;
  std::optional<double> low, high;  // bounds of the y axis; empty: chosen from the values
  bool is_signed = false;           // true: values are changes, so the axis has signs and a line at 0
  bool logarithmic = false;
  bool names = true;  // true: the names of the series stand at the ends of their lines
  int width = 620, height = 320;
};
std::string svg_of(const LineChart& chart);

// Grouped bars that start at 0, with the value over each bar. The chart grows wider than `width` where the bars need
// it.
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
