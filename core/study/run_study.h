// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the cells of a study and stores them in a folder (batch/cell_store.h). A cell is one combination of spacing,
// pose and technique (way of posing). Finished cells are not computed again, so a run may be killed at any moment and
// continued later. Each cell's folder also contains ratio.nrrd and overlap.nrrd.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/study/study.h"

namespace limber {

// One cell of a study, as indices into the study's lists of spacings, poses and techniques.
struct StudyCell {
  int spacing = 0, pose = 0, technique = 0;
};
// Returns the cells in the order in which they are computed: by spacing, then pose, then technique.
std::vector<StudyCell> cells_of(const Study& study);
std::string text_of(const Study& study, const StudyCell& cell);  // returns text such as "2 mm, +45, FEM"

struct CellOutcome {
  StudyCell cell;
  Path folder;          // folder with the cell's result
  std::string failure;  // why the cell could not be computed; empty if it was computed
};

// Convert between a volume ratio (volume of tissue in the pose divided by its volume at rest) and its code in the file
// ratio.nrrd: the byte 128 + 16 * log2(ratio), limited to [1, 255]. Voxels of air have the code 0.
std::uint8_t code_of_ratio(double ratio);
double ratio_of_code(int code);

struct StudyRun {
  Path out;
  int shard = 0, shards = 1;  // this run computes only the cells whose index modulo `shards` equals `shard`
  int threads = 0;            // number of threads of each worker process; 0: all cores
  // Called when a cell is done. `done` of `of` cells are done. `was_there` is true if the result of an earlier run was
  // used. `seconds_left` is the estimated time of the remaining cells, negative if it is not known.
  std::function<void(const CellOutcome&, int done, int of, bool was_there, double seconds_left)> on_cell;
};

// Computes this run's share of the study's cells and returns their outcomes, in the order of cells_of(). Throws Error
// if an input is wrong or the folder cannot be written, and Cancelled if the user cancels.
std::vector<CellOutcome> run_study(const Study& study, const StudyRun& run, Progress& progress);

}  // namespace limber
