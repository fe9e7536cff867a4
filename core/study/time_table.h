// SPDX-License-Identifier: AGPL-3.0-or-later
// Makes a table of the times of a study's techniques, in seconds and relative to linear blend skinning.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/study/cell_result.h"

namespace limber {

// The median, the least and the largest of some values.
struct Spread {
  double median = 0, least = 0, most = 0;
};
std::optional<Spread> spread_of(std::vector<double> values);  // returns nothing if there are no values

// The times of one technique at one spacing, over its bent poses; over all poses if none is bent.
struct TechniqueTime {
  std::optional<Spread> seconds;    // seconds of all repeats of all poses
  std::optional<Spread> of_linear;  // time of each pose divided by that of linear blend skinning; empty: not computed
};
TechniqueTime time_of(const Study& study, const std::vector<CellResult>& cells, int spacing, int technique);

// Returns the head and rows of a table in HTML, one row for each spacing and technique.
//   unit  "CPU s" or "s"        names  HTML of the name of each technique
std::string time_rows(const Study& study, const std::vector<CellResult>& cells, const std::string& unit,
                      const std::vector<std::string>& names);

}  // namespace limber
