// SPDX-License-Identifier: AGPL-3.0-or-later
// Every figure of every cell, for programs.
#pragma once

#include <string>
#include <vector>

#include "core/study/cell_result.h"

namespace limber {

// {"schema": "limber-study/1", "version", "study": {...}, "cells": [{"spacing_mm", "pose", "method", "key",
// "cpu_seconds", ...,
//  "gates": [{"id", "name", "passed"?, "figure"?, "worst"?}], "report": limber-report/1} | {..., "failure"}]}
std::string cells_json(const Study& study, const std::vector<CellResult>& cells);

// A row for each cell, a column for each figure of any report ("tissues.fat.volume_change_percent"); empty where a cell
// has none.
std::string cells_csv(const Study& study, const std::vector<CellResult>& cells);

}  // namespace limber
