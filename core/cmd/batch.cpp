// SPDX-License-Identifier: AGPL-3.0-or-later
// limber batch BATCH.json -o OUT [--plan] [--cells N,N-M] [--shard i/n] [--threads N] [--progress json]: computes those
//   combinations of body, pose and technique of a batch (batch/batch.h) that have no result yet, and collects their
//   figures in tables. With --plan, only lists the cells.
#include <cstdio>
#include <memory>

#include "core/base/error.h"
#include "core/batch/run_batch.h"
#include "core/cmd/command.h"
#include "core/cmd/command_files.h"
#include "core/cmd/shard_option.h"

namespace limber::cmd {

namespace {
struct BatchOptions {
  std::string batch, out, shard, cells;
  bool plan = false;
  RunOptions run;
};

// Returns the cell numbers in a list such as "1,5,7-9", each once, in ascending order.
std::vector<int> numbers_of(const std::string& text, int cell_count) {
  std::vector<bool> is_named(std::size_t(cell_count) + 1, false);
  const auto refuse = [&] {
    throw Error("this is not a list of cell numbers", "--cells " + text,
                "write numbers from 1 to " + std::to_string(cell_count) + ", as in 1,5,7-9");
  };
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const std::string part = text.substr(at, comma - at);
    int first = 0, last = 0, end = 0;
    if (std::sscanf(part.c_str(), "%d%n-%d%n", &first, &end, &last, &end) < 2) last = first;
    if (part.empty() || end != int(part.size()) || first < 1 || last < first || last > cell_count) refuse();
    for (int number = first; number <= last; ++number) is_named[number] = true;
    at = comma + 1;
  }
  std::vector<int> numbers;
  for (int number = 1; number <= cell_count; ++number)
    if (is_named[number]) numbers.push_back(number);
  return numbers;
}

void print_plan(const Batch& batch, const std::vector<BatchOutcome>& cells, const std::vector<int>& numbers,
                const std::string& out) {
  print("cell\tstate\tbody\tpose\tmethod\tfolder\n");
  std::size_t next = 0;
  for (const BatchOutcome& cell : cells) {
    if (!numbers.empty() && (next == numbers.size() || numbers[next] != cell.number)) continue;
    ++next;
    print("%d\t%s\t%s\t%s\t%s\t%s\n", cell.number, cell.is_there() ? "done" : "missing",
          one_line(batch.bodies[cell.cell.body].name).c_str(), one_line(batch.poses[cell.cell.pose].name).c_str(),
          word_of(batch.techniques[cell.cell.technique]).c_str(),
          (Path(out) / "cells" / cell.stored.folder.filename()).string().c_str());
  }
}

void run_batch(const BatchOptions& options) {
  CommandProgress progress(options.run.progress);
  const Batch batch = read_batch(options.batch);
  const int cell_count = int(cells_of(batch).size());
  BatchRun run{.out = options.out, .threads = options.run.threads};
  if (!options.cells.empty()) run.numbers = numbers_of(options.cells, cell_count);
  if (!options.shard.empty()) {
    run.numbers = numbers_of_shard(read_shard(options.shard), cell_count);
    if (run.numbers.empty() && !options.plan) return tell("shard " + options.shard + " has no cells");
  }
  if (options.plan) return print_plan(batch, find_batch(batch, options.out), run.numbers, options.out);
  run.on_cell = [&](const BatchOutcome& outcome, int done, int of) {
    const std::string failure = outcome.failure();
    const bool was_there = outcome.stored.state == CellState::WasThere;
    tell(std::to_string(done) + " of " + std::to_string(of) + "  " + text_of(batch, outcome.cell) + ": " +
         (!failure.empty() ? "FAILED: " + failure
          : was_there      ? "already computed"
                           : "done"));
  };
  const std::vector<BatchOutcome> outcomes = run_batch(batch, run, progress);
  if (run.numbers.empty()) {
    write_tables(batch, outcomes, options.out);
    print("%s\n%s\n", (Path(options.out) / "cells.csv").string().c_str(),
          (Path(options.out) / "times.csv").string().c_str());
  }
  const auto failed = std::count_if(outcomes.begin(), outcomes.end(),
                                    [](const BatchOutcome& outcome) { return !outcome.failure().empty(); });
  if (failed)
    throw Error(std::to_string(failed) + " of " + std::to_string(outcomes.size()) + " cells failed", options.out,
                "see the lines above, then run the same command again: it computes only what is missing");
}
}  // namespace

void add_batch(CLI::App& app) {
  auto* command = app.add_subcommand("batch",
                                     "computes all combinations (cells) of bodies, poses or frames, methods and "
                                     "exports; finished cells are kept, and several machines may share a folder");
  auto options = std::make_shared<BatchOptions>();
  command
      ->add_option("BATCH", options->batch, "description of the batch (JSON): its bodies, poses, methods and exports")
      ->required();
  writes(command->add_option(
             "-o,--output", options->out,
             "folder for the cells, and for cells.csv and times.csv when all are computed; created if missing"),
         [](const std::string& folder) {
           return OptionFiles{{}, {Path(folder) / "cells.csv", Path(folder) / "times.csv"}};
         })
      ->required();
  command->add_flag(
      "--plan", options->plan,
      "only lists the cells, one per line: number, state, body, pose, method and folder, separated by tabs");
  auto* cells =
      command->add_option("--cells", options->cells, "computes only the cells with these numbers, which --plan lists")
          ->type_name("N,N-M");
  command
      ->add_option("--shard", options->shard,
                   "computes only every n-th cell, starting with the i-th, to share the work among n machines")
      ->type_name("i/n")
      ->excludes(cells);
  add_run_options(*command, options->run);
  command->callback([options] { run_batch(*options); });
}

}  // namespace limber::cmd
