// SPDX-License-Identifier: AGPL-3.0-or-later
// The quality gates for a solve by finite elements, besides those of quality_gates.h:
//   reached  the solve reached the pose and converged there
//   gap      there is air between parts of the skin that the pose brings near each other
#pragma once

#include "core/report/quality_gate.h"

namespace limber {

// Returns the gates `reached` and `gap`.
//   report  JSON text of schema limber-report/1; if it is not JSON, or of another method, the gates are not measured
std::vector<QualityGate> solve_gates(const std::string& report);

}  // namespace limber
