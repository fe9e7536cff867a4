// SPDX-License-Identifier: AGPL-3.0-or-later
// Packs a study with its inputs and results into a folder, so that others can compute it again and check that they get
// the same digits. The folder contains:
//   study.json     the description, whose paths lead into inputs/
//   inputs/        copies of the input files; without those that must not be copied
//   expected.json  version, hashes of the inputs, hashes of all posed voxels, and all figures except times and memory
//   README.txt     how to run and check it
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/study/cell_result.h"

namespace limber {

enum class BundleVolumes { Copy, LeaveOut };

// Writes the bundle. The folder must be missing or empty. Throws Error if it cannot be written, if a cell of the study
// failed, or if an input refers to other files (.gltf).
//   commit  the commit that the program was built from; "": unknown
void write_bundle(const Study& study, const std::vector<CellResult>& cells, const Path& folder, BundleVolumes volumes,
                  const std::string& commit, Progress& progress);

// Throws Error unless the study's input files have the hashes that the file of expected results, expected.json,
// contains. Call this before a long run.
void check_inputs(const Study& study, const Path& expected);

// Compares results with the expected ones: the label of every posed voxel, and every digit of every figure. Throws
// Error with the first differences if they differ, or if the expected results are those of another study. Returns a
// sentence that says what was compared.
std::string check_results(const Study& study, const std::vector<CellResult>& cells, const Path& expected,
                          Progress& progress);

}  // namespace limber
