// SPDX-License-Identifier: AGPL-3.0-or-later
// What a solve by finite elements must pass beside quality_gates.h:
//   reached  it came to the pose, and settled there
//   gap      there is air between skins that came near each other
#pragma once

#include "core/report/quality_gate.h"

namespace limber {

// In the order above.
//   report  limber-report/1, JSON; of another method, or from text that is none, nothing is measured
std::vector<QualityGate> solve_gates(const std::string& report);

}  // namespace limber
