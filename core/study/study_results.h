// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the results of a study: cells.csv, cells.json, observations.csv and report.html. The page also shows the SAR
// values of OUT/sar.json.
#pragma once

#include "core/base/progress.h"
#include "core/study/picture.h"
#include "core/study/run_study.h"

namespace limber {

// Writes the four files of results, each completely or not at all. Throws Error if they cannot be written.
//   command  the command line that ran the study; the report shows it
//   start    returns the function that draws bodies in 3D; may be empty
void write_results(const Study& study, const std::vector<CellOutcome>& outcomes, const Path& out,
                   const std::string& command, const StartPictures& start, Progress& progress);

}  // namespace limber
