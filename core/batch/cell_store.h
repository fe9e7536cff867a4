// SPDX-License-Identifier: AGPL-3.0-or-later
// A folder with computed cells. A cell is one body in one pose by one technique (way of posing). A worker process runs
// each cell as a `limber job`. The same job can be run from the command line, and the process's memory and processor
// time can be measured. Finished cells are stored under a hash of everything that they depend on, including the
// program's own sources, and are not computed again. The folder contains:
//   inputs/   copies of rigs, tissues and poses, to which the jobs refer
//   bodies/   a body's volume and skin weights
//   cells/    job.json, report.json (limber-report/1), cell.json and the volumes that the job writes
// A folder in bodies/ or cells/ appears only when it is complete, so a run may be killed at any moment and continued
// later. Several programs on several machines may fill one store.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/batch/described_body.h"
#include "core/batch/described_pose.h"
#include "core/batch/technique.h"
#include "core/batch/work_folder.h"

namespace limber {

// Settings that all cells of a run share.
struct CellSettings {
  std::string quality = "normal";  // quality of solves by finite elements: draft, normal or fine
  std::string glide;               // value of the option --glide of `limber resample`; empty: its default
  bool fit_joints = false, nearest = false;
  int repeats = 1;  // how many times a cell is computed, to measure its time; all runs must give the same result
  // The file names of a cell's outputs, by the option of `limber resample` that names them: {"output", "posed.nrrd"}.
  std::map<std::string, std::string> outputs;
  std::string mesh;  // file name of the mesh of a solve by finite elements; empty: none
};

struct CellRequest {
  const DescribedBody& body;
  const DescribedPose& pose;
  const Technique& technique;
  const CellSettings& settings;
  std::string name;   // the start of the cell's folder name
  std::string facts;  // JSON object: the first entries of cell.json
};

enum class CellState { Missing, Busy, WasThere, Made, Failed };
struct StoredCell {
  CellState state = CellState::Missing;
  Path folder;
  std::string key;      // the hash of everything that the cell depends on
  std::string failure;  // why the cell could not be computed; empty unless Failed
};

class CellStore {
 public:
  // Creates the folder and its subfolders.
  //   threads  number of threads of each worker process; 0: all cores
  CellStore(const Path& folder, int threads);
  ~CellStore();
  CellStore(const CellStore&) = delete;
  CellStore& operator=(const CellStore&) = delete;

  const Path& folder() const { return folder_; }

  // Looks for the cell in the store without computing anything. The state is WasThere or Missing.
  StoredCell find(const CellRequest& request);
  // Computes the cell, and first the volume and the weights of its body if they are not in the store. With
  // IfBusy::Leave the state is Busy if another program is computing the cell or its body. Throws Error if the disk is
  // full, since then no other cell could be computed either. Throws Cancelled if the user cancels.
  //   finish  called with the cell's working folder after the job, to add files made from the job's outputs
  StoredCell compute(const CellRequest& request, IfBusy if_busy, Progress& progress,
                     const std::function<void(const WorkFolder&)>& finish = {});
  // find_export() looks in exports/ for an export of a cell (a file of another format, made from its posed volume).
  // compute_export() computes the export.
  //   job  JSON object for `limber job`, with file names in the export's folder; its input is the cell's posed volume
  StoredCell find_export(const StoredCell& cell, const std::string& name, const std::string& job) const;
  StoredCell compute_export(const StoredCell& cell, const std::string& name, const std::string& job, IfBusy if_busy,
                            Progress& progress) const;

  // An input file that take() has copied into the store, so that jobs can be run again after the store has moved: its
  // path relative to a cell's folder, and its hash. A .gltf file is not copied, since it refers to other files by their
  // paths.
  struct Input {
    Path path;
    std::string sha256;
  };
  const Input& take(const Path& file);

 private:
  struct Parts;
  Path folder_;
  std::unique_ptr<Parts> parts_;
};

// Returns the wall-clock seconds that computing a cell took. Returns 0 if its cell.json does not say.
double wall_seconds_of(const Path& cell_folder);

// Returns the text with only those characters that are safe in a file name, and at most 60 of them.
std::string file_word(const std::string& text);

}  // namespace limber
