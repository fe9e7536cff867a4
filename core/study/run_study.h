// SPDX-License-Identifier: AGPL-3.0-or-later
// Computes the cells of a study into a folder, each by a worker that runs `limber job` on a file that stays with the
// result: what the command line would do, with a process's own memory and processor time. Done cells are kept under a
// hash of all that they depend on, the program's own sources included, and never computed again:
//   inputs/   rig, tissues, poses: copies that the jobs refer to
//   bodies/   volume and weights at each spacing
//   cells/    job.json, report.json (limber-report/1), posed.nrrd, ratio.nrrd, overlap.nrrd, cell.json
// A folder appears there when it is whole, so a run may be killed at any moment and be taken up again.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/study/study.h"

namespace limber {

// Indices into the study.
struct StudyCell {
  int spacing = 0, pose = 0, technique = 0;
};
// In the order in which they are computed: spacing, then pose, then technique.
std::vector<StudyCell> cells_of(const Study& study);
std::string text_of(const Study& study, const StudyCell& cell);  // "2 mm, +45, FEM"

struct CellOutcome {
  StudyCell cell;
  Path folder;          // of the result
  std::string failure;  // why there is none; empty otherwise
};

// What ratio.nrrd holds: volume per volume at rest, a byte for each posed voxel, in steps of 1/16 of a doubling about
// 128; 0 in air.
std::uint8_t code_of_ratio(double ratio);
double ratio_of_code(int code);

struct StudyRun {
  Path out;
  int shard = 0, shards = 1;  // cell i is of shard i mod shards
  int threads = 0;            // of each worker; 0: every core
  // A cell is done; `seconds_left` is an estimate for the others, negative where there is none.
  std::function<void(const CellOutcome&, int done, int of, bool was_there, double seconds_left)> on_cell;
};

// The outcomes of the shard's cells, in order.
//   throws Error where an input is wrong or the folder cannot be written, Cancelled
std::vector<CellOutcome> run_study(const Study& study, const StudyRun& run, Progress& progress);

}  // namespace limber
