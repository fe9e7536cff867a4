// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/newton.h"

#include <algorithm>
#include <cmath>

namespace limber {

namespace {
constexpr double kSufficient = 1e-4;  // share of the first-order decrease that a step must achieve [Armijo 1966]
constexpr double kFurthest = 8;       // upper limit on the length of an extended step, in full Newton steps
constexpr int kHalvings = 24;         // number of halvings of a step after which the search gives up
constexpr double kShort = 0.5;        // share of a step: if limits allow less than this, a smoothed step is tried too
constexpr double kJam = 0.05;         // share of the full Newton step: a shorter step counts as a jam
// While the distance of touching parts is below this many thicknesses of the barrier, the solve never counts as
// converged: a Newton step then only doubles the distance, so it is short although the force is far too large.
constexpr double kSqueezed = 1e-3;
// Damping of the Hessian (FemEnergy::newton_step) after a poor iteration: a jam, or a search that achieves less than
// the share kPoor of the decrease that the slope predicts. Each further poor iteration increases it. Where parts of the
// skin meet along parallel edges, the Hessian lacks some of the energy's curvature, and an undamped step leads far
// along such an edge.
constexpr double kDamped = 1e-2;
constexpr double kPoor = 0.03;
// A step that would move a node further than this share of the mesh's extent is useless. It is not searched either,
// since most of the skin would count as near along it, but damped.
constexpr double kWild = 0.5;
constexpr double kMostDamping = 10;  // wild steps are searched if even this damping does not make them shorter
constexpr int kMostDamped = 16;      // upper limit on the number of good iterations in a row that stay damped
constexpr int kJams = 3;             // number of jams in a row after which the solve gives up
// The solve has converged only if the last line search left out at most this much of the full Newton step: the longest
// motion of a node in the remainder, as a share of the tolerance.
constexpr double kLeft = 0.25;
// Some nodes, the stragglers, may still move further than the tolerance when the solve ends (NewtonSettings), but none
// further than this many tolerances.
constexpr double kStraggle = 3;
constexpr int kStalls = 4;  // number of iterations over which the energy must stall (NewtonSettings::stalled)

// The damping of the next iteration. The first good iteration ends it. If undamped steps prove poor again, twice as
// many iterations stay damped from then on.
class Damping {
 public:
  double value() const { return value_; }
  void update(bool is_poor) {
    if (is_poor) {
      if (value_ == 0) {
        left_ = held_;
        held_ = std::min(2 * held_ + 1, kMostDamped);
      }
      value_ = std::max(kDamped, 10 * value_);
    } else if (value_ > kDamped) value_ /= 10;
    else if (left_ > 0) --left_;
    else value_ = 0;
  }

 private:
  double value_ = 0;
  int held_ = 0, left_ = 0;  // number of further good iterations that stay damped: after the next poor one, and now
};

double extent(const NodePositions& x) {
  return x.rows() ? (x.colwise().maxCoeff() - x.colwise().minCoeff()).norm() : 0;
}

double longest(const NodePositions& step) {
  return step.rows() ? std::sqrt(step.rowwise().squaredNorm().maxCoeff()) : 0;
}

bool settled(const NodePositions& step, double longest, const NewtonSettings& settings) {
  if (longest < settings.tolerance_mm) return true;
  if (longest >= kStraggle * settings.tolerance_mm) return false;
  const auto moving = (step.rowwise().squaredNorm().array() >= settings.tolerance_mm * settings.tolerance_mm).count();
  return double(moving) <= settings.stragglers * double(step.rows());
}

// Line search: moves x to x + length * step, where the energy is lower. Returns the length; 0: no lower energy was
// found.
//   bound  the first length tried, at most 1. If a full step lowers the energy well, longer steps are tried too
double search(FemEnergy& energy, NodePositions& x, double& value, const NodePositions& step, double slope,
              double bound) {
  const double rounding = 1e-13 * std::abs(value);
  double length = bound;
  NodePositions there;
  double best = value;
  for (int k = 0;; ++k, length *= 0.5) {
    if (k == kHalvings) return 0;
    there = x + length * step;
    best = energy.value(there);
    if (best <= value - kSufficient * length * slope + rounding) break;
  }
  // Extends the step if the parabola through the known energies predicts a lower energy at length 2 than at length 1.
  if (length == 1 && slope > 0 && 3 * (best - value + slope) < slope) {
    const double furthest = energy.largest_step(x, step, kFurthest).length;
    NodePositions further;
    for (double next = 2; next <= furthest; next *= 2) {
      further = x + next * step;
      const double lower = energy.value(further);
      if (!(lower < best - rounding)) break;
      best = lower;
      length = next;
      there.swap(further);
    }
  }
  x.swap(there);
  value = best;
  return length;
}

// Makes two line searches for a step that limits have shortened: one along the step, one along the step smoothed around
// what limits it. Moves x to the lower energy of the two, since the smoothed step may be long and yet lower the energy
// less.
//   bound  in: the limit of the step; out: the limit of the step that was taken, this or the smoothed one
double search_both(FemEnergy& energy, NodePositions& x, double& value, const NodePositions& step, double slope,
                   const std::vector<char>& fixed, FemEnergy::Bound& bound) {
  const NodePositions around = energy.limit_step(x, step, fixed);
  const FemEnergy::Bound further = energy.largest_step(x, around, 1);
  NodePositions smoothed = x;
  double value_of_smoothed = value, length = 0;
  if (further.length > bound.length) length = search(energy, smoothed, value_of_smoothed, around, 0, further.length);
  // The energy is valid only along the motion that was searched for contact last.
  energy.largest_step(x, step, 1);
  const NodePositions start = x;
  const double of_step = search(energy, x, value, step, slope, bound.length);
  if (length == 0 || (of_step > 0 && value <= value_of_smoothed)) return of_step;
  energy.largest_step(start, around, 1);
  x.swap(smoothed);
  value = value_of_smoothed;
  bound = further;
  return length;
}
}  // namespace

NewtonResult minimise(FemEnergy& energy, NodePositions& x, const NewtonSettings& settings, Progress& progress,
                      const std::function<void(int, double)>& on_iteration) {
  NewtonResult result;
  int jams = 0;
  Damping damping;
  double value = energy.value(x);
  std::vector<double> values;  // the energy before each iteration
  NodePositions step;
  while (result.iterations < settings.iterations) {
    if (progress.cancelled()) throw Cancelled();
    double slope = 0;
    if (!energy.newton_step(x, HessianKind::Projected, step, slope, nullptr, damping.value())) break;
    ++result.iterations;
    values.push_back(value);
    result.residual = longest(step);
    const bool may_damp = energy.tightest() < 1;
    if (may_damp && damping.value() < kMostDamping && result.residual > kWild * extent(x)) {
      damping.update(true);
      continue;
    }

    result.bound = energy.largest_step(x, step, 1);
    const bool is_short = result.bound.length < kShort;
    const double length = is_short ? search_both(energy, x, value, step, slope, settings.fixed, result.bound)
                                   : search(energy, x, value, step, slope, result.bound.length);
    result.shortest_search = std::min(result.shortest_search, length);
    if (on_iteration) on_iteration(result.iterations, result.residual);
    jams = length < kJam ? jams + 1 : 0;
    if (jams == kJams) break;
    // If damped, a short step does not show that the solve has converged, unless it is very short and taken whole.
    const bool is_damped = damping.value() > 0;
    const bool is_still = length >= 1 && damping.value() <= kDamped && result.residual < kLeft * settings.tolerance_mm;
    damping.update(may_damp && (length < kJam || values.back() - value < kPoor * slope));
    if (length == 0) {
      // If the step is too short to matter, the solve has converged; otherwise a damped step may find a lower energy.
      result.converged = !is_damped && result.residual < settings.tolerance_mm;
      if (result.converged || !may_damp) break;
      continue;
    }
    if ((!is_damped || is_still) && settled(step, result.residual, settings) && energy.tightest() > kSqueezed &&
        (1 - length) * result.residual < kLeft * settings.tolerance_mm) {
      result.converged = true;
      break;
    }
    if (std::ssize(values) >= kStalls && values.end()[-kStalls] - value < settings.stalled * value &&
        settled(step, result.residual, settings) && energy.tightest() > kSqueezed) {
      result.converged = true;
      break;
    }
  }
  return result;
}

}  // namespace limber
