// SPDX-License-Identifier: AGPL-3.0-or-later
// Projected Newton to the shape of least energy. No iterate ever has an inverted tet or skin that crosses: every
// step is bounded (step_bound.h, contact_surface.h) and searched along, and a search that finds nothing lower does not
// move. The curvature is the projected one throughout: up to the last iterations of a deep bend the exact one is
// indefinite, or so nearly that its steps lead nowhere. It ends when neither the step nor what a search left of it
// matters, and gives up when three searches in a row hardly moved. A full step that lowers the energy is tried at 2, 4,
// 8 times its length. A step that one place bounds to less than half is made smoother there first, so that it can be
// taken everywhere else.
#pragma once

#include <functional>
#include <vector>

#include "core/base/progress.h"
#include "core/fem/fem_energy.h"

namespace limber {

struct NewtonSettings {
  double tolerance_mm = 0.3;  // ends when no node would move further than this
  double stragglers = 0;  // share of the nodes that may, up to 3 times as far: a few of many thousands hover for long
  int iterations = 40;
  std::vector<char> fixed;  // #nodes: 1 where a step is not made smoother (FemEnergy::yielding); empty: nowhere
};

struct NewtonResult {
  bool converged = false;
  int iterations = 0;
  double residual = 0;         // furthest that a node wanted to move in the last iteration, mm
  double shortest_search = 1;  // of all steps taken, in shares of the full step
  FemEnergy::Bound bound;      // of the last step
};

// x  in: positive tets, on the way that the energy watches; out: the least energy found, never higher than where it
// began on_iteration(iteration, residual) after each
NewtonResult minimise(FemEnergy& energy, NodePositions& x, const NewtonSettings& settings,
                      Progress& progress = no_progress(), const std::function<void(int, double)>& on_iteration = {});

}  // namespace limber
