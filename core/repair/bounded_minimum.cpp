// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/repair/bounded_minimum.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace limber {

namespace {

constexpr int kPairs = 12;  // number of latest steps from which the Hessian is approximated
// Share of the decrease predicted by the slope that a step must reach (Armijo condition).
constexpr double kArmijo = 1e-4;
constexpr int kMostHalvings = 12;
constexpr double kFirstStep = 0.05;  // largest change of a variable in the first step

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

// A step and the change of the gradient over it.
struct Pair {
  std::vector<double> step, change;
  double curvature = 0;  // dot product of step and change
};

// Returns minus the approximate inverse Hessian times the gradient, by the two-loop recursion.
std::vector<double> descent(const std::deque<Pair>& pairs, std::vector<double> q) {
  std::vector<double> share(pairs.size());
  for (std::size_t k = pairs.size(); k-- > 0;) {
    share[k] = dot(pairs[k].step, q) / pairs[k].curvature;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] -= share[k] * pairs[k].change[i];
  }
  double scale = 1;
  if (!pairs.empty()) {
    scale = pairs.back().curvature / dot(pairs.back().change, pairs.back().change);
  } else {
    double largest = 1e-300;
    for (const double each : q) largest = std::max(largest, std::abs(each));
    scale = kFirstStep / largest;
  }
  for (double& each : q) each *= scale;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const double back = dot(pairs[k].change, q) / pairs[k].curvature;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += (share[k] - back) * pairs[k].step[i];
  }
  for (double& each : q) each = -each;
  return q;
}

bool is_held(double x, double slope) { return (x <= 0 && slope > 0) || (x >= 1 && slope < 0); }

}  // namespace

BoundedMinimum bounded_minimum(const Differentiable& function, std::vector<double> x, int most, double least,
                               const std::function<void(int)>& on_step) {
  const std::size_t count = x.size();
  std::vector<double> gradient(count), free(count), next(count), next_gradient(count);
  double value = function(x, gradient);
  std::deque<Pair> pairs;
  int iteration = 0, small_steps = 0;
  while (iteration < most && small_steps < 3) {
    for (std::size_t i = 0; i < count; ++i) free[i] = is_held(x[i], gradient[i]) ? 0 : gradient[i];
    std::vector<double> way = descent(pairs, free);
    for (std::size_t i = 0; i < count; ++i)
      if (is_held(x[i], gradient[i])) way[i] = 0;
    if (dot(way, free) >= 0) {
      if (pairs.empty()) break;
      pairs.clear();
      continue;
    }
    double next_value = 0;
    bool found = false;
    double length = 1;
    for (int halving = 0; halving < kMostHalvings && !found; ++halving, length /= 2) {
      double expected = 0;
      for (std::size_t i = 0; i < count; ++i) {
        next[i] = std::clamp(x[i] + length * way[i], 0.0, 1.0);
        expected += gradient[i] * (next[i] - x[i]);
      }
      next_value = function(next, next_gradient);
      found = next_value <= value + kArmijo * expected;
    }
    if (!found) {
      if (pairs.empty()) break;
      pairs.clear();
      continue;
    }
    Pair pair{std::vector<double>(count), std::vector<double>(count)};
    for (std::size_t i = 0; i < count; ++i) {
      pair.step[i] = next[i] - x[i];
      pair.change[i] = next_gradient[i] - gradient[i];
    }
    pair.curvature = dot(pair.step, pair.change);
    if (pair.curvature > 1e-10 * dot(pair.change, pair.change)) {
      pairs.push_back(std::move(pair));
      if (pairs.size() > kPairs) pairs.pop_front();
    }
    small_steps = value - next_value < least ? small_steps + 1 : 0;
    value = next_value;
    x.swap(next);
    gradient.swap(next_gradient);
    on_step(++iteration);
  }
  return {std::move(x), value, iteration};
}

}  // namespace limber
