// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the figures of many reports as tidy CSV, one figure per row, for R, pandas and spreadsheets [RFC 4180].
#pragma once

#include <string>
#include <vector>

namespace limber {

struct Observed {
  std::vector<std::string> fields;  // the values of the given columns, which come first
  std::string report;               // text of the report (limber-report/1); empty if there is none
  std::string cell;                 // text of the file cell.json
  std::string failure;              // why the cell has no report; empty if it has one
};

// Returns CSV with the given columns, followed by group, item, quantity and value: "tissues", "fat",
// "volume_change_percent", "-0.2". Booleans are written as 1 and 0. Times, memory and file names are left out, so that
// the same poses give the same text on every machine. A cell that failed has one row, with the quantity "failure".
std::string observations_csv(const std::vector<std::string>& columns, const std::vector<Observed>& cells);

// Returns CSV with the given columns, followed by machine, quantity and value: the seconds of each stage ("solve_s"),
// the processor seconds of the cell's process ("cpu_s") and its largest memory ("peak_memory_mb").
std::string times_csv(const std::vector<std::string>& columns, const std::vector<Observed>& cells);

}  // namespace limber
