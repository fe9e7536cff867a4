// SPDX-License-Identifier: AGPL-3.0-or-later
// Minimizes a smooth function of many variables in [0, 1] by the limited-memory BFGS method with projection: a variable
// at a bound that a step would leave is kept fixed during the step, and steps are clipped to the bounds [Nocedal &
// Wright 2006, Numerical optimization, 7.2; Bertsekas 1982, Projected Newton methods].
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/base/progress.h"

namespace limber {

struct BoundedMinimum {
  std::vector<double> x;
  double value = 0;
  int iterations = 0;
};

// Returns the value of the function at x, and writes its gradient.
using Differentiable = std::function<double(std::span<const double> x, std::span<double> gradient)>;

// Starts from x, which must lie in [0, 1], and never returns a larger value than at the start. Ends after `most`
// iterations, or when an iteration lowers the value by less than `least`. The result does not depend on the number of
// threads.
//   on_step  called after each iteration with its number
BoundedMinimum bounded_minimum(const Differentiable& function, std::vector<double> x, int most, double least,
                               const std::function<void(int)>& on_step);

}  // namespace limber
