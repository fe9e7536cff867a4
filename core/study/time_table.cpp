// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/time_table.h"

#include <algorithm>

#include "core/study/text.h"

namespace limber {

namespace {

const CellResult* find_cell(const std::vector<CellResult>& cells, const StudyCell& at) {
  for (const CellResult& one : cells)
    if (one.done() && one.cell.spacing == at.spacing && one.cell.pose == at.pose && one.cell.technique == at.technique)
      return &one;
  return nullptr;
}

// Returns the cells of a technique at a spacing whose pose turns a joint; all of them if no pose does.
std::vector<const CellResult*> bent_cells(const std::vector<CellResult>& cells, int spacing, int technique) {
  std::vector<const CellResult*> all, bent;
  for (const CellResult& one : cells) {
    if (!one.done() || one.cell.spacing != spacing || one.cell.technique != technique) continue;
    all.push_back(&one);
    if (!one.joints.empty()) bent.push_back(&one);
  }
  return bent.empty() ? all : bent;
}

int decimals_of(double value) { return value < 1 ? 2 : value < 100 ? 1 : 0; }

// Returns two HTML table cells: the median, and the range from least to largest value.
std::string spread_cells(const std::optional<Spread>& spread) {
  if (!spread) return "<td class=\"none\">–</td><td class=\"none\">–</td>";
  const auto text = [&](double value) { return fixed(value, decimals_of(spread->median)); };
  return "<td>" + text(spread->median) + "</td><td>" + text(spread->least) + " to " + text(spread->most) + "</td>";
}

}  // namespace

std::optional<Spread> spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return Spread{values.size() % 2 ? values[middle] : (values[middle - 1] + values[middle]) / 2, values.front(),
                values.back()};
}

TechniqueTime time_of(const Study& study, const std::vector<CellResult>& cells, int spacing, int technique) {
  const auto linear = std::find(study.techniques.begin(), study.techniques.end(), Technique{"lbs"});
  std::vector<double> seconds, ratios;
  for (const CellResult* one : bent_cells(cells, spacing, technique)) {
    seconds.insert(seconds.end(), one->cpu_repeats.begin(), one->cpu_repeats.end());
    if (linear == study.techniques.end()) continue;
    const CellResult* of =
        find_cell(cells, {spacing, one->cell.pose, static_cast<int>(linear - study.techniques.begin())});
    if (of && of->cpu_seconds > 0) ratios.push_back(one->cpu_seconds / of->cpu_seconds);
  }
  return {spread_of(std::move(seconds)), spread_of(std::move(ratios))};
}

std::string time_rows(const Study& study, const std::vector<CellResult>& cells, const std::string& unit,
                      const std::vector<std::string>& names) {
  std::string rows =
      "<thead><tr><th rowspan=\"2\">Spacing</th><th rowspan=\"2\" class=\"word\">Technique</th><th "
      "colspan=\"2\">Time<small>" +
      unit +
      "</small></th><th colspan=\"2\">Divided by linear blend’s "
      "time</th></tr><tr><th>median</th><th>range</th><th>median</th>"
      "<th>range</th></tr></thead>";
  for (int s = 0; s < std::ssize(study.spacings); ++s) {
    rows += "<tbody>";
    for (int t = 0; t < std::ssize(study.techniques); ++t) {
      const TechniqueTime time = time_of(study, cells, s, t);
      rows += "<tr>";
      if (t == 0)
        rows += "<th class=\"row pose\" rowspan=\"" + std::to_string(study.techniques.size()) + "\">" +
                escaped(spacing_text(study.spacings[std::size_t(s)])) + "</th>";
      rows += "<th class=\"row\">" + names[std::size_t(t)] + "</th>" + spread_cells(time.seconds) +
              spread_cells(time.of_linear) + "</tr>";
    }
    rows += "</tbody>";
  }
  return rows;
}

}  // namespace limber
