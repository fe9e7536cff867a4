// SPDX-License-Identifier: AGPL-3.0-or-later
// The gates that a solve by finite elements must pass besides those of quality_gates.h:
//   reached  the solve reached the pose and converged there
//   gap      there is air between skins that came near each other
#pragma once

#include "core/report/quality_gate.h"

namespace limber {

// Returns the gates `reached` and `gap`.
//   report  limber-report/1, JSON; when it is of another method, or not JSON, the gates are not measured
std::vector<QualityGate> solve_gates(const std::string& report);

}  // namespace limber
