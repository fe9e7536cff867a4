// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes every figure of every cell of a study as JSON and CSV, for other programs to read.
#pragma once

#include <string>
#include <vector>

#include "core/study/cell_result.h"

namespace limber {

// Returns {"schema": "limber-study/1", "version", "study": {...}, "cells": [{"spacing_mm", "pose", "method", "key",
//          "cpu_seconds", ..., "gates": [{"id", "name", "passed"?, "figure"?, "worst"?}],
//          "report": limber-report/1} | {..., "failure"}]}
std::string cells_json(const Study& study, const std::vector<CellResult>& cells);

// Returns CSV with a row for each cell and a column for each figure that any report has
// ("tissues.fat.volume_change_percent"). A field is empty where the cell lacks the figure.
std::string cells_csv(const Study& study, const std::vector<CellResult>& cells);

}  // namespace limber
