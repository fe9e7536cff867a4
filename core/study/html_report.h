// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes a study, or the results of an editor session (session_page.h), as one HTML page: summary, pictures, quality
// gates, tissues, SAR values if they were computed, and provenance. The page is a single file without scripts. It suits
// light and dark mode and print on A4.
#pragma once

#include <string>
#include <vector>

#include "core/study/figures.h"
#include "core/study/sar_figures.h"
#include "core/study/scores.h"

namespace limber {

struct ReportFacts {
  Path out;
  std::string command;  // the command line that made the study
  std::string commit;   // the commit that the program was built from; "": unknown
  std::string date;     // date on which the report is written
  std::optional<SarFigures> sar;
  // The scores that raters gave for how real the bodies look. Empty: there are no scores.
  std::optional<RatingResult> rating;
  bool of_session = false;  // true: results of an editor session, with wall-clock times and no cell folders
};
std::string date_text();  // returns the present time: "2025-03-07 14:05"

std::string html_report(const Study& study, const std::vector<CellResult>& cells, const StudyFigures& figures,
                        const ReportFacts& facts);

}  // namespace limber
