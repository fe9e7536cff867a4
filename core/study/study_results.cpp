// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/study_results.h"

#include "core/batch/observations.h"
#include "core/study/html_report.h"
#include "core/study/tables.h"

namespace limber {

namespace {
std::string study_observations(const Study& study, const std::vector<CellResult>& cells) {
  std::vector<Observed> observed;
  for (const CellResult& cell : cells) {
    const DescribedPose& pose = study.poses[cell.cell.pose];
    observed.push_back(
        {{spacing_text(study.spacings[cell.cell.spacing]), pose.sequence.empty() ? pose.name : pose.sequence,
          pose.frame ? std::to_string(*pose.frame) : "", word_of(study.techniques[cell.cell.technique])},
         cell.report,
         cell.cell_json,
         cell.failure});
  }
  return observations_csv({"spacing", "pose", "frame", "method"}, observed);
}
}  // namespace

void write_results(const Study& study, const std::vector<CellOutcome>& outcomes, const Path& out,
                   const std::string& command, const StartPictures& start, Progress& progress) {
  std::vector<CellResult> cells;
  for (const CellOutcome& outcome : outcomes) cells.push_back(read_result(study, outcome));
  write_file_atomically(out / "cells.csv", cells_csv(study, cells));
  write_file_atomically(out / "cells.json", cells_json(study, cells));
  write_file_atomically(out / "observations.csv", study_observations(study, cells));
  const std::optional<SarFigures> sar = read_sar(out, study, cells);
  const StudyFigures figures = make_figures(study, cells, start, progress);
  write_file_atomically(out / "report.html", html_report(study, cells, figures, {out, command, date_text(), sar}));
}

}  // namespace limber
