// SPDX-License-Identifier: AGPL-3.0-or-later
// Minimises the energy by projected Newton steps with a line search. No iterate ever has an inverted tet or skin that
// crosses itself: every step is limited (step_bound.h, contact_surface.h), and a line search that finds no lower energy
// does not move. All steps use the projected Hessian, because until the last iterations of a deep bend the exact
// Hessian is indefinite or nearly so, and its steps are useless. The solve ends when the full Newton step is shorter
// than the tolerance and the line search has taken almost all of it. The solve gives up after three searches in a row
// that hardly moved. After a poor search the Hessian is damped. A full step that lowers the energy well is also tried
// at 2, 4 and 8 times its length. A step that is limited to less than half of its length is first smoothed around the
// tets or pairs that limit it, so that the other nodes can take it.
#pragma once

#include <functional>
#include <vector>

#include "core/base/progress.h"
#include "core/fem/fem_energy.h"

namespace limber {

struct NewtonSettings {
  double tolerance_mm = 0.3;  // the solve ends when no node would move further than this in a full step
  // Largest share of the nodes that may move further than the tolerance (up to 3 times as far) in the last step, since
  // a few of many thousands of nodes converge very slowly.
  double stragglers = 0;
  // The solve also ends when no node would move further than the tolerance and the energy has stalled: a few iterations
  // together have lowered it by less than this share. Contact then keeps steps short, and they hardly change the shape.
  double stalled = 0;
  int iterations = 40;
  std::vector<char> fixed;  // #nodes: 1 for nodes whose step is never smoothed (FemEnergy::limit_step); empty: none
};

struct NewtonResult {
  bool converged = false;
  int iterations = 0;
  double residual = 0;         // longest motion of a node in the last full Newton step, mm
  double shortest_search = 1;  // shortest step that a line search took, as a share of the full Newton step
  FemEnergy::Bound bound;      // how far the last step could go, and the tet or contact pair that limited it
};

// Minimises the energy, starting at x.
//   x             in: positions without inverted tets, for which build_broad_phase() was called; out: the positions
//                 with the lowest energy found
//   on_iteration  on_iteration(iteration, residual) is called after each iteration
//   throws Cancelled
NewtonResult minimise(FemEnergy& energy, NodePositions& x, const NewtonSettings& settings,
                      Progress& progress = no_progress(), const std::function<void(int, double)>& on_iteration = {});

}  // namespace limber
