// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/study_results.h"

#include "core/batch/observations.h"
#include "core/study/html_report.h"
#include "core/study/tables.h"
#include "core/study/text.h"

namespace limber {

namespace {
const std::vector<std::string> kColumns = {"spacing_mm", "pose", "frame", "method"};

std::vector<Observed> observed(const Study& study, const std::vector<CellResult>& cells) {
  std::vector<Observed> observed;
  for (const CellResult& cell : cells) {
    const DescribedPose& pose = study.poses[cell.cell.pose];
    const auto& spacing = study.spacings[cell.cell.spacing];
    observed.push_back({{spacing ? number(*spacing) : "", pose.sequence.empty() ? pose.name : pose.sequence,
                         pose.frame ? std::to_string(*pose.frame) : "", word_of(study.techniques[cell.cell.technique])},
                        cell.report,
                        cell.cell_json,
                        cell.failure});
  }
  return observed;
}
}  // namespace

std::vector<CellResult> read_results(const Study& study, const std::vector<CellOutcome>& outcomes) {
  std::vector<CellResult> cells;
  for (const CellOutcome& outcome : outcomes) cells.push_back(read_result(study, outcome));
  return cells;
}

void write_results(const Study& study, const std::vector<CellResult>& cells, const ResultsRequest& request,
                   const StartPictures& start, Progress& progress) {
  const Path& out = request.out;
  std::vector<RaterScores> raters;
  for (const Path& file : request.scores) raters.push_back(read_scores(file));
  write_file_atomically(out / "cells.csv", cells_csv(study, cells));
  write_file_atomically(out / "cells.json", cells_json(study, cells, request.commit));
  write_file_atomically(out / "observations.csv", observations_csv(kColumns, observed(study, cells)));
  write_file_atomically(out / "times.csv", times_csv(kColumns, observed(study, cells)));
  ReportFacts facts{.out = out, .command = request.command, .commit = request.commit, .date = date_text()};
  facts.sar = read_sar(out, study, cells);
  const StudyFigures figures = make_figures(study, cells, start, progress);
  const std::vector<RatedPicture> pictures = rated_pictures(study, cells, figures);
  if (request.rating_form) {
    write_file_atomically(out / "rating.html", rating_form(study, pictures, figures.slices.legend));
    write_file_atomically(out / "rating_key.csv", rating_key(study, pictures));
  }
  if (!raters.empty()) {
    facts.rating = rate(study, pictures, raters);
    write_file_atomically(out / "scores.csv", facts.rating->csv);
  }
  write_file_atomically(out / "report.html", html_report(study, cells, figures, facts));
}

}  // namespace limber
