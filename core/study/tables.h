// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes every figure of every cell of a study (one spacing, pose and technique) as JSON and CSV, for other programs.
#pragma once

#include <string>
#include <vector>

#include "core/study/cell_result.h"

namespace limber {

// Returns the JSON text
//   {"schema": "limber-study/1", "version", "commit", "sources", "study": {...}, "cells": [
//     {"spacing_mm", "pose", "method", "key", "cpu_seconds", ...,
//      "repeats"?: {"cpu_seconds": [...], "wall_seconds": [...]},
//      "gates": [{"id", "name", "passed"?, "figure"?, "worst"?}],
//      "label_gates": [{"label", "name", "voxels", "volume_change_percent", "passed"}],
//      "report": limber-report/1} | {..., "failure"}]}
//   commit  the commit that the program was built from; "": unknown
std::string cells_json(const Study& study, const std::vector<CellResult>& cells, const std::string& commit);

// Returns CSV with one row for each cell and one column for each figure in the cells' reports
// ("tissues.fat.volume_change_percent"). A field is empty if the cell lacks the figure.
std::string cells_csv(const Study& study, const std::vector<CellResult>& cells);

}  // namespace limber
