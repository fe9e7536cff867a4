// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the results of a study: cells.csv, cells.json, observations.csv, times.csv and report.html. The page also
// shows the SAR values of OUT/sar.json. On request, also writes the form on which raters score pictures without knowing
// their technique (rating.html, with its key rating_key.csv), and the scores that raters gave (scores.csv, and a
// section of the page).
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/study/cell_result.h"
#include "core/study/picture.h"

namespace limber {

struct ResultsRequest {
  Path out;
  std::string command;  // the command line that ran the study; the report shows it
  std::string commit;   // the commit that the program was built from; "": unknown
  bool rating_form = false;
  std::vector<Path> scores;  // files that raters saved from the form
};

// Returns the results of the cells. Throws Error if files of a cell cannot be read.
std::vector<CellResult> read_results(const Study& study, const std::vector<CellOutcome>& outcomes);

// Writes the files of results, each completely or not at all. Throws Error if they cannot be written, or a file of
// scores is wrong.
//   start    returns the function that draws bodies in 3D; may be empty
void write_results(const Study& study, const std::vector<CellResult>& cells, const ResultsRequest& request,
                   const StartPictures& start, Progress& progress);

}  // namespace limber
