// SPDX-License-Identifier: AGPL-3.0-or-later
// A study, or the results of a session (session_page.h), as one page: summary, figures, gates, tissues, SAR where it
// was computed, provenance. Everything is in the file, nothing runs in it; it reads in a browser in light and dark, and
// printed on A4.
#pragma once

#include <string>
#include <vector>

#include "core/study/figures.h"
#include "core/study/sar_figures.h"

namespace limber {

struct ReportFacts {
  Path out;
  std::string command;  // that made it
  std::string date;     // of the report
  std::optional<SarFigures> sar;
  bool of_session = false;  // results that were made one by one, by the clock; no cells lie beside the page
};
std::string date_text();  // of now: "2025-03-07 14:05"

std::string html_report(const Study& study, const std::vector<CellResult>& cells, const StudyFigures& figures,
                        const ReportFacts& facts);

}  // namespace limber
