// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes what a study found: cells.csv, cells.json and report.html, which shows what sar.json there holds, too.
#pragma once

#include "core/base/progress.h"
#include "core/study/picture.h"
#include "core/study/run_study.h"

namespace limber {

//   command  as it was called, for the report
//   start    draws bodies in 3D, or none
//   throws Error where they cannot be written; each file is whole or as before
void write_results(const Study& study, const std::vector<CellOutcome>& outcomes, const Path& out,
                   const std::string& command, const StartPictures& start, Progress& progress);

}  // namespace limber
