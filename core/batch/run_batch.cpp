// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/batch/run_batch.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/batch/observations.h"
#include "core/batch/part_of_progress.h"

namespace limber {

namespace {
using Json = nlohmann::ordered_json;

// Interval between two checks for cells that other programs compute.
constexpr auto kPause = std::chrono::milliseconds(200);

class BatchStore {
 public:
  BatchStore(const Batch& batch, const Path& out, int threads) : batch_(batch), store_(out, threads) {}

  BatchOutcome find(const BatchCell& cell, int number) {
    BatchOutcome outcome{cell, number, store_.find(request_of(cell)), {}};
    for (const BatchExport& one : batch_.exports)
      outcome.exports.push_back(store_.find_export(outcome.stored, name_of(cell), job_of(cell, outcome.stored, one)));
    return outcome;
  }

  // Computes a cell and its exports, unless another program computes one of them.
  BatchOutcome compute(const BatchCell& cell, int number, Progress& progress) {
    BatchOutcome outcome{cell, number, store_.compute(request_of(cell), IfBusy::Leave, progress), {}};
    if (outcome.stored.state == CellState::Busy || outcome.stored.state == CellState::Failed) return outcome;
    for (const BatchExport& one : batch_.exports)
      outcome.exports.push_back(store_.compute_export(outcome.stored, name_of(cell), job_of(cell, outcome.stored, one),
                                                      IfBusy::Leave, progress));
    return outcome;
  }

 private:
  std::string name_of(const BatchCell& cell) const {
    return file_word(batch_.bodies[cell.body].name) + "-" + file_word(batch_.poses[cell.pose].name) + "-" +
           word_of(batch_.techniques[cell.technique]);
  }
  CellRequest request_of(const BatchCell& cell) const {
    const DescribedBody& body = batch_.bodies[cell.body];
    const DescribedPose& pose = batch_.poses[cell.pose];
    const Technique& technique = batch_.techniques[cell.technique];
    const Json facts{{"body", body.name}, {"pose", pose.name}, {"method", word_of(technique)}};
    return {body,          pose,
            technique,     batch_.settings,
            name_of(cell), facts.dump(-1, ' ', false, Json::error_handler_t::replace)};
  }
  // Returns the job that makes an export of the cell.
  std::string job_of(const BatchCell& cell, const StoredCell& stored, const BatchExport& one) {
    const DescribedBody& body = batch_.bodies[cell.body];
    const Path posed = Path("../../cells") / stored.folder.filename() / batch_.settings.outputs.at("output");
    Json job{{"command", "convert"}, {"volume", posed.string()}, {"output", "posed" + one.ending}};
    if (!body.tissues.empty()) job["tissues"] = store_.take(body.tissues).path.string();
    if (one.frequency > 0) job["frequency"] = one.frequency;
    if (!one.properties.empty()) job["properties"] = store_.take(one.properties).path.string();
    return job.dump(-1, ' ', false, Json::error_handler_t::replace);
  }

  const Batch& batch_;
  CellStore store_;
};

bool is_busy(const BatchOutcome& outcome) {
  return outcome.stored.state == CellState::Busy ||
         std::any_of(outcome.exports.begin(), outcome.exports.end(),
                     [](const StoredCell& one) { return one.state == CellState::Busy; });
}

std::vector<std::string> fields_of(const Batch& batch, const BatchCell& cell) {
  const DescribedPose& pose = batch.poses[cell.pose];
  return {batch.bodies[cell.body].name, pose.sequence.empty() ? pose.name : pose.sequence,
          pose.frame ? std::to_string(*pose.frame) : "", word_of(batch.techniques[cell.technique])};
}
}  // namespace

bool BatchOutcome::is_there() const {
  const auto is_stored = [](const StoredCell& one) {
    return one.state == CellState::WasThere || one.state == CellState::Made;
  };
  return is_stored(stored) && std::all_of(exports.begin(), exports.end(), is_stored);
}

std::string BatchOutcome::failure() const {
  if (!stored.failure.empty()) return stored.failure;
  for (const StoredCell& one : exports)
    if (!one.failure.empty()) return one.failure;
  return {};
}

std::vector<BatchOutcome> find_batch(const Batch& batch, const Path& out) {
  BatchStore store(batch, out, 0);
  std::vector<BatchOutcome> outcomes;
  for (const BatchCell& cell : cells_of(batch)) outcomes.push_back(store.find(cell, int(outcomes.size()) + 1));
  return outcomes;
}

std::vector<BatchOutcome> run_batch(const Batch& batch, const BatchRun& run, Progress& progress) {
  const std::vector<BatchCell> cells = cells_of(batch);
  std::vector<int> open = run.numbers;
  if (open.empty())
    for (int number = 1; number <= std::ssize(cells); ++number) open.push_back(number);
  const int of = int(open.size());
  BatchStore store(batch, run.out, run.threads);
  std::vector<BatchOutcome> outcomes;
  while (!open.empty()) {
    std::vector<int> busy;
    for (const int number : open) {
      if (progress.cancelled()) throw Cancelled();
      const BatchCell& cell = cells[number - 1];
      const double done = double(outcomes.size());
      PartOfProgress part(
          progress, std::to_string(outcomes.size() + 1) + " of " + std::to_string(of) + ", " + text_of(batch, cell),
          done / of, (done + 1) / of);
      BatchOutcome outcome = store.compute(cell, number, part);
      if (is_busy(outcome)) {
        busy.push_back(number);
        continue;
      }
      outcomes.push_back(std::move(outcome));
      if (run.on_cell) run.on_cell(outcomes.back(), int(outcomes.size()), of);
      progress.update("batch", double(outcomes.size()) / of);
    }
    if (busy.size() == open.size()) std::this_thread::sleep_for(kPause);
    open = std::move(busy);
  }
  std::sort(outcomes.begin(), outcomes.end(),
            [](const BatchOutcome& a, const BatchOutcome& b) { return a.number < b.number; });
  return outcomes;
}

void write_tables(const Batch& batch, const std::vector<BatchOutcome>& outcomes, const Path& out) {
  std::vector<Observed> cells;
  for (const BatchOutcome& outcome : outcomes) {
    Observed cell{.fields = fields_of(batch, outcome.cell), .failure = outcome.failure()};
    if (outcome.stored.state == CellState::WasThere || outcome.stored.state == CellState::Made) {
      cell.report = read_file(outcome.stored.folder / "report.json");
      cell.cell = read_file(outcome.stored.folder / "cell.json");
    }
    cells.push_back(std::move(cell));
  }
  const std::vector<std::string> columns = {"body", "pose", "frame", "method"};
  write_file_atomically(out / "cells.csv", observations_csv(columns, cells));
  write_file_atomically(out / "times.csv", times_csv(columns, cells));
}

}  // namespace limber
