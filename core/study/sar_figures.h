// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads what a simulation found for a study's posed bodies: OUT/sar.json, which the command
// `assets/examples/sar_openems.py study OUT` writes:
//   {"schema": "limber-sar/2", "frequency_hz", "cell_mm", "polarization", "towards", "spacing_mm", "method",
//    "poses": [{"pose", "key", "sar_average_w_per_kg", "sar_peak_10g_w_per_kg", "mass_kg", "cells", "seconds",
//               and how the peak was found: "sar_peak_found", "cells_valid", "cells_used", "cells_unused",
//               "cells_without", "cells_heavier_than_10g"}],
//    "sphere": {"cell_mm", "absorbed_w", "absorbed_by_mie_w", "difference_percent"}}
// Version 1 of the file is refused: it averaged over cubes that IEC/IEEE 62704-1 does not define.
// SAR values are for an incident power density of 1 W/m2. `key` is the key of the cell that was simulated.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/study/cell_result.h"

namespace limber {

struct SarFigures {
  struct Body {
    const CellResult* cell = nullptr;
    double average = 0, peak_10g = 0;  // W/kg
    double mass_kg = 0, seconds = 0;
    std::int64_t cells = 0;
  };
  struct Sphere {
    double cell_mm = 0, absorbed = 0, by_mie = 0, difference_percent = 0;  // absorbed (simulated) and by_mie (exact): W
  };
  double frequency_hz = 0, cell_mm = 0;
  std::string polarization, towards;
  std::vector<Body> bodies;           // sorted by pose; all of one spacing and technique
  std::vector<std::string> outdated;  // poses left out of `bodies`, since their cells changed after the simulation
  Sphere sphere;
};

// Reads OUT/sar.json. Returns nothing where the file is missing. Throws Error where it is damaged.
std::optional<SarFigures> read_sar(const Path& out, const Study& study, const std::vector<CellResult>& cells);

}  // namespace limber
