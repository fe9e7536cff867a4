// SPDX-License-Identifier: AGPL-3.0-or-later
// limber experiment STUDY.json|arm [DIR] [--methods M,M] -o OUT [--shard i/n] [--threads N] [--progress json]
//   [--rating-form] [--scores FILE,FILE] [--bundle FOLDER [--without-volumes]] [--expect expected.json]: computes
//   those combinations of spacing, pose and technique of a study that have no result yet, and writes the study's tables
//   and report. `arm` is the built-in study; DIR is a folder with its volumes, M a technique.
#include "core/cmd/experiment.h"

#include <filesystem>
#include <memory>

#include "core/base/error.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/shard_option.h"
#include "core/study/bundle.h"
#include "core/study/study_results.h"
#include "core/study/text.h"

namespace limber::cmd {

namespace {
struct ExperimentOptions {
  std::string study, folder, out, shard;
  std::vector<std::string> methods;
  bool rating_form = false, without_volumes = false;
  std::vector<std::string> scores;
  std::string bundle, expect;
  RunOptions run;
};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

void tell_cell(const Study& study, const CellOutcome& outcome, int done, int of, bool was_there, double seconds_left) {
  std::string line = std::to_string(done) + " of " + std::to_string(of) + "  " + text_of(study, outcome.cell) + ": ";
  line += outcome.failure.empty() ? was_there ? "already computed" : "done" : "FAILED: " + outcome.failure;
  if (done < of && seconds_left > 0) line += ", " + minutes_text(seconds_left) + " left";
  tell(line);
}

// Writes tables, report and the requested extra files, and compares the results with expected ones if they are given.
void write(const ExperimentOptions& options, const Study& study, const std::vector<CellOutcome>& outcomes,
           const std::string& commit, const StartPictures& pictures, Progress& progress) {
  const std::vector<CellResult> cells = read_results(study, outcomes);
  const std::string command = "limber experiment " + options.study +
                              (options.folder.empty() ? "" : " " + options.folder) + " -o " + options.out +
                              (options.methods.empty() ? "" : " --methods " + joined(options.methods));
  ResultsRequest request{.out = options.out, .command = command, .commit = commit, .rating_form = options.rating_form};
  request.scores.assign(options.scores.begin(), options.scores.end());
  write_results(study, cells, request, pictures, progress);
  for (const char* name : {"report.html", "cells.csv", "cells.json"}) print("%s\n", (Path(options.out) / name).c_str());
  if (options.rating_form) print("%s\n", (Path(options.out) / "rating.html").c_str());
  if (!options.bundle.empty()) {
    write_bundle(study, cells, options.bundle, options.without_volumes ? BundleVolumes::LeaveOut : BundleVolumes::Copy,
                 commit, progress);
    print("%s\n", options.bundle.c_str());
  }
  if (!options.expect.empty()) print("%s\n", check_results(study, cells, options.expect, progress).c_str());
}

void run_experiment(const ExperimentOptions& options, const std::string& commit, const StartPictures& pictures) {
  CommandProgress progress(options.run.progress);
  if (options.study != "arm" && !options.folder.empty())
    throw Error("only the built-in study arm takes a folder", options.folder,
                "write: limber experiment arm " + options.folder + " -o " + options.out);
  Study study = options.study == "arm" ? paper_study(options.folder) : read_study(options.study);
  if (!options.methods.empty()) study.techniques = techniques_of(options.methods, "--methods");
  if (!options.expect.empty()) check_inputs(study, options.expect);
  StudyRun run{.out = options.out, .threads = options.run.threads};
  if (!options.shard.empty()) {
    const Shard shard = read_shard(options.shard);
    run.shard = shard.index;
    run.shards = shard.count;
  }
  run.on_cell = [&](const CellOutcome& outcome, int done, int of, bool was_there, double left) {
    tell_cell(study, outcome, done, of, was_there, left);
  };
  const std::vector<CellOutcome> outcomes = run_study(study, run, progress);

  std::size_t failed = 0;
  for (const CellOutcome& outcome : outcomes) failed += !outcome.failure.empty();
  if (run.shards == 1) {
    write(options, study, outcomes, commit, pictures, progress);
  } else {
    tell("the cells of shard " + options.shard +
         " are done: run the same command without --shard to collect the results");
  }
  if (failed)
    throw Error(std::to_string(failed) + " of " + std::to_string(outcomes.size()) + " cells failed", options.out,
                "see the lines above, then run the same command again: it computes only what is missing");
}

OptionFiles files_of_folder(const std::string& folder) {
  OptionFiles files;
  for (const char* name : {"cells.csv", "cells.json", "observations.csv", "times.csv", "report.html"})
    files.written.push_back(Path(folder) / name);
  return files;
}
}  // namespace

void add_experiment(CLI::App& app, const std::string& commit, const StartPictures& pictures) {
  auto* command = app.add_subcommand("experiment",
                                     "computes a study of poses, techniques and spacings, with tables and a report; "
                                     "finished cells are kept, run it again to continue");
  auto options = std::make_shared<ExperimentOptions>();
  command
      ->add_option(
          "STUDY", options->study,
          "description (JSON), or the word arm: a built-in study of the elbow at 2, 3 and 4 mm, by every technique")
      ->required();
  command->add_option(
      "DIR", options->folder,
      "only for the study arm: a folder with man-arm-2mm.mha and its armature (default: the procedural arm)");
  writes(
      command->add_option("-o,--output", options->out,
                          "folder for cells.csv, cells.json, report.html and all computed files; created if missing"),
      files_of_folder)
      ->required();
  command
      ->add_option("--methods", options->methods,
                   technique_words() +
                       "; each also with the suffix -mass-exact (default: the methods of the description, or lbs, "
                       "dqs, fem and fem-contact)")
      ->delimiter(',')
      ->type_name("M,M");
  command
      ->add_option("--shard", options->shard,
                   "computes only every n-th cell, starting with the i-th, to share the work among n machines")
      ->type_name("i/n");
  command->add_flag(
      "--rating-form", options->rating_form,
      "also writes rating.html, a blind rating form for the pictures, and rating_key.csv, which names the techniques");
  command
      ->add_option("--scores", options->scores,
                   "files that raters saved from rating.html: their scores and agreement are added to the report")
      ->delimiter(',')
      ->type_name("FILE,FILE");
  auto* bundle = writes(command->add_option("--bundle", options->bundle,
                                            "new folder to write: the description, all inputs and the results, so that "
                                            "the study can be reproduced elsewhere"));
  command
      ->add_flag("--without-volumes", options->without_volumes,
                 "do not copy volumes into the bundle, store only their hashes")
      ->needs(bundle);
  command->add_option(
      "--expect", options->expect,
      "compares the results with expected.json of a bundle, and fails unless every voxel and every number is the same");
  add_run_options(*command, options->run);
  command->callback([options, commit, pictures] { run_experiment(*options, commit, pictures); });
}

}  // namespace limber::cmd
