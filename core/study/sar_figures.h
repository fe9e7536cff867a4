// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the specific absorption rates (SAR) that a simulation found in a study's posed bodies. The command
// `assets/examples/sar_openems.py study OUT` simulates the results in folder OUT and writes OUT/sar.json:
//   {"schema": "limber-sar/2", "frequency_hz", "cell_mm", "polarization", "towards", "spacing_mm", "method",
//    "poses": [{"pose", "key", "sar_average_w_per_kg", "sar_peak_10g_w_per_kg", "mass_kg", "cells", "seconds",
//               and how the peak was found: "sar_peak_found", "cells_valid", "cells_used", "cells_unused",
//               "cells_without", "cells_heavier_than_10g"}],
//    "sphere": {"cell_mm", "absorbed_w", "absorbed_by_mie_w", "difference_percent"}}
// Version 1 of the file is refused: it averaged over cubes that IEC/IEEE 62704-1 does not define. SAR values are for an
// incident power density of 1 W/m2. `key` is the key of the study's cell (one spacing, pose and technique) that was
// simulated.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/study/cell_result.h"

namespace limber {

struct SarFigures {
  struct Body {
    const CellResult* cell = nullptr;
    double average = 0, peak_10g = 0;  // SAR, W/kg: mean over the body, largest mean over 10 g of tissue
    double mass_kg = 0, seconds = 0;
    std::int64_t cells = 0;
  };
  struct Sphere {
    // The power that the sphere absorbs, W: simulated (absorbed) and exact (by_mie), and the difference between both.
    double cell_mm = 0, absorbed = 0, by_mie = 0, difference_percent = 0;
  };
  double frequency_hz = 0, cell_mm = 0;
  std::string polarization, towards;
  std::vector<Body> bodies;           // simulated bodies, sorted by pose; all of one spacing and technique
  std::vector<std::string> outdated;  // poses left out of `bodies`, since their results changed after the simulation
  Sphere sphere;
};

// Reads the file sar.json in the folder `out`. Returns nothing if the file is missing. Throws Error if it is damaged.
std::optional<SarFigures> read_sar(const Path& out, const Study& study, const std::vector<CellResult>& cells);

}  // namespace limber
