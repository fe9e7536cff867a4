// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the cells of a study into a folder. A cell is one combination of spacing, pose and technique. Each cell runs
// in a worker process as a `limber job` whose file stays with the result, so it does what the command line would do,
// and its memory and processor time can be measured. Finished cells are stored under a hash of everything that they
// depend on, including the program's own sources, and are never computed again. The folder contains:
//   inputs/   rig, tissues, poses: copies that the jobs refer to
//   bodies/   volume and weights at each spacing
//   cells/    job.json, report.json (limber-report/1), posed.nrrd, ratio.nrrd, overlap.nrrd, cell.json
// A cell's folder appears only when it is complete, so a run may be killed at any moment and continued later.
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
std::string text_of(const Study& study, const StudyCell& cell);  // "2 mm, +45, FEM"

struct CellOutcome {
  StudyCell cell;
  Path folder;          // folder of the result
  std::string failure;  // reason for which there is no result; empty when there is one
};

// The values of ratio.nrrd: each voxel of the posed volume has its volume relative to rest as a byte, 128 + 16 *
// log2(ratio), limited to [1, 255]. Air has 0.
std::uint8_t code_of_ratio(double ratio);
double ratio_of_code(int code);

struct StudyRun {
  Path out;
  int shard = 0, shards = 1;  // this run computes the cells whose index modulo `shards` equals `shard`
  int threads = 0;            // number of threads of each worker; 0: all cores
  // Called when a cell is done. `was_there` is true for a cell of an earlier run. `seconds_left` is an estimate for the
  // remaining cells, negative without an estimate.
  std::function<void(const CellOutcome&, int done, int of, bool was_there, double seconds_left)> on_cell;
};

// Computes the cells of this run's shard and returns their outcomes, in order. Throws Error where an input is wrong or
// the folder cannot be written, and Cancelled after a cancel.
std::vector<CellOutcome> run_study(const Study& study, const StudyRun& run, Progress& progress);

}  // namespace limber
