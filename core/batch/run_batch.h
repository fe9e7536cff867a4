// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the cells of a batch (batch.h) and stores them in a folder (cell_store.h), with the exports of each cell in
// exports/. Any number of programs on any number of machines may compute one batch into one shared folder at the same
// time: each skips cells that another program is computing. When all cells are computed, the figures of all reports are
// written to cells.csv and times.csv (observations.h).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/batch/batch.h"

namespace limber {

struct BatchOutcome {
  BatchCell cell;
  int number = 0;  // number of the cell, from 1
  StoredCell stored;
  std::vector<StoredCell> exports;  // in the order of the batch's exports; empty if the cell is missing or failed

  bool is_there() const;        // true if cell and exports are in the store
  std::string failure() const;  // why the cell or an export could not be computed; "" if all were computed
};

struct BatchRun {
  Path out;
  std::vector<int> numbers;  // the cells to compute, counted from 1; empty: all
  int threads = 0;           // number of threads of each worker process; 0: all cores
  // Called when a cell is done, with the number of cells that are done and the number of all cells.
  std::function<void(const BatchOutcome&, int done, int of)> on_cell;
};

// Finds which cells of the batch are in the store, without computing anything.
std::vector<BatchOutcome> find_batch(const Batch& batch, const Path& out);

// Computes the cells and returns their outcomes, in the order of their numbers. A cell that fails does not stop the
// others. Waits for cells that other programs compute. Throws Error if an input is wrong or the folder cannot be
// written, and Cancelled if the user cancels.
std::vector<BatchOutcome> run_batch(const Batch& batch, const BatchRun& run, Progress& progress);

// Writes cells.csv and times.csv, with the columns body, pose, frame and method. Throws Error if a file cannot be
// written.
void write_tables(const Batch& batch, const std::vector<BatchOutcome>& outcomes, const Path& out);

}  // namespace limber
