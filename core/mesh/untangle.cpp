// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/untangle.h"

#include <algorithm>
#include <cmath>
#include <deque>

#include <Eigen/Dense>

#include "core/base/parallel.h"

namespace limber {

namespace {

constexpr int kRounds = 20;        // upper limit on the number of rounds; each round has less regularization
constexpr int kSteps = 25;         // steps of L-BFGS in a round
constexpr int kMemory = 6;         // number of earlier steps from which L-BFGS approximates the Hessian
constexpr int kRings = 2;          // nodes up to this number of edges away from a tet that is inside out may move
constexpr int kPatience = 4;       // after this many rounds in a row without a further upright tet, no more are done
constexpr double kUpright = 1e-4;  // a tet counts as upright if its volume exceeds this share of its volume at rest
constexpr std::int64_t kGrain = 2048;

// The tets with a node that moves, and the energy of their distortion.
class Region {
 public:
  Region(const Eigen::MatrixX3d& V, const Eigen::MatrixX3d& rest, const Eigen::MatrixX4i& T,
         const std::vector<int>& wrong, const std::vector<bool>& fixed) {
    std::vector<std::uint8_t> near(V.rows(), 0);
    for (const int t : wrong)
      for (const int node : T.row(t)) near[node] = 1;
    for (int ring = 0; ring < kRings; ++ring) {
      std::vector<std::uint8_t> wider = near;
      for (const auto& tet : T.rowwise())
        if (std::any_of(tet.begin(), tet.end(), [&](int node) { return near[node] != 0; }))
          for (const int node : tet) wider[node] = 1;
      near.swap(wider);
    }
    std::vector<int> number(V.rows(), -1);
    for (Eigen::Index node = 0; node < V.rows(); ++node)
      if (near[node] && !fixed[node]) number[node] = static_cast<int>(nodes_.size()), nodes_.push_back(int(node));
    for (const auto& tet : T.rowwise()) {
      Tet each;
      bool moves = false;
      for (int i = 0; i < 4; ++i) {
        each.free[i] = number[tet[i]];
        moves |= each.free[i] >= 0;
        each.held[i] = V.row(tet[i]).transpose();
      }
      if (!moves) continue;
      Eigen::Matrix3d edges;
      for (int i = 0; i < 3; ++i) edges.col(i) = (rest.row(tet[i + 1]) - rest.row(tet[0])).transpose();
      each.from_rest = edges.inverse();
      tets_.push_back(each);
    }
    corners_.resize(nodes_.size() + 1, 0);
    for (const Tet& tet : tets_)
      for (const int node : tet.free)
        if (node >= 0) ++corners_[node + 1];
    for (std::size_t i = 1; i < corners_.size(); ++i) corners_[i] += corners_[i - 1];
    corner_.resize(corners_.back());
    std::vector<int> next(corners_.begin(), corners_.end() - 1);
    for (std::size_t t = 0; t < tets_.size(); ++t)
      for (int i = 0; i < 4; ++i)
        if (tets_[t].free[i] >= 0) corner_[next[tets_[t].free[i]]++] = static_cast<int>(4 * t) + i;
    slope_.resize(tets_.size());
  }

  const std::vector<int>& nodes() const { return nodes_; }

  // Returns the smallest ratio of a tet's volume to its volume at rest, and the number of tets below kUpright.
  std::pair<double, std::int64_t> least(const Eigen::VectorXd& x) const {
    std::pair<double, std::int64_t> least(INFINITY, 0);
    for (const Tet& tet : tets_) {
      const double ratio = stretch(tet, x).determinant();
      least.first = std::min(least.first, ratio);
      least.second += !(ratio > kUpright);
    }
    return least;
  }

  // Returns the energy, and sets its gradient.
  //   epsilon  regularization, a ratio of volumes: keeps the energy of flat and of inside-out tets finite. A smaller
  //            epsilon gives these tets a larger energy
  double value(const Eigen::VectorXd& x, double epsilon, Eigen::VectorXd& gradient) {
    const double sum = parallel_sum(std::ssize(tets_), kGrain, [&](std::int64_t begin, std::int64_t end) {
      double part = 0;
      for (std::int64_t t = begin; t < end; ++t) part += value_of(tets_[t], x, epsilon, slope_[t]);
      return part;
    });
    gradient.resize(x.size());
    parallel_for(std::ssize(nodes_), kGrain, [&](std::int64_t begin, std::int64_t end) {
      for (std::int64_t node = begin; node < end; ++node) {
        Eigen::Vector3d all = Eigen::Vector3d::Zero();
        for (int i = corners_[node]; i < corners_[node + 1]; ++i) {
          const auto& slope = slope_[corner_[i] / 4];
          const int corner = corner_[i] % 4;
          all += corner == 0 ? Eigen::Vector3d(-slope.rowwise().sum()) : Eigen::Vector3d(slope.col(corner - 1));
        }
        gradient.segment<3>(3 * node) = all;
      }
    });
    return sum;
  }

 private:
  struct Tet {
    std::array<int, 4> free;              // index of the corner's node in nodes_; -1: the node does not move
    std::array<Eigen::Vector3d, 4> held;  // positions of the corners; used for those that do not move
    Eigen::Matrix3d from_rest;            // inverse of the matrix of the edges at rest
  };

  static Eigen::Matrix3d stretch(const Tet& tet, const Eigen::VectorXd& x) {
    const auto at = [&](int i) -> Eigen::Vector3d {
      return tet.free[i] < 0 ? tet.held[i] : Eigen::Vector3d(x.segment<3>(3 * tet.free[i]));
    };
    Eigen::Matrix3d edges;
    for (int i = 0; i < 3; ++i) edges.col(i) = at(i + 1) - at(0);
    return edges * tet.from_rest;
  }

  // Returns the energy |J|^2 / d^(2/3) + (det J^2 + 1) / d of a tet with deformation gradient J, where d is det J, made
  // positive. `slope` is set to the derivative by the tet's edges.
  static double value_of(const Tet& tet, const Eigen::VectorXd& x, double epsilon, Eigen::Matrix3d& slope) {
    const Eigen::Matrix3d J = stretch(tet, x);
    const double det = J.determinant(), root = std::sqrt(epsilon * epsilon + det * det);
    // For a large negative determinant the sum det + root would lose all its digits, so an equal quotient is used.
    const double d = det > 0 ? 0.5 * (det + root) : 0.5 * epsilon * epsilon / (root - det);
    const double d_slope = d / root, power = std::cbrt(d * d), norm = J.squaredNorm();
    Eigen::Matrix3d cofactor;
    cofactor.col(0) = J.col(1).cross(J.col(2));
    cofactor.col(1) = J.col(2).cross(J.col(0));
    cofactor.col(2) = J.col(0).cross(J.col(1));
    const double by_det = -2.0 / 3 * norm / (power * d) * d_slope + 2 * det / d - (det * det + 1) / (d * d) * d_slope;
    slope = (2 / power * J + by_det * cofactor) * tet.from_rest.transpose();
    return norm / power + (det * det + 1) / d;
  }

  std::vector<int> nodes_;  // the nodes that move
  std::vector<Tet> tets_;
  // The corners of tets at the moving node i, as 4 * tet + corner, are corner_[corners_[i]] up to
  // corner_[corners_[i + 1] - 1].
  std::vector<int> corners_, corner_;
  std::vector<Eigen::Matrix3d> slope_;
};

// Minimises the energy by L-BFGS [Nocedal 1980]; every step reduces the energy. Returns false if no first step does.
bool descend(Region& region, Eigen::VectorXd& x, double epsilon) {
  struct Pair {
    Eigen::VectorXd step, change;
    double scale;
  };
  std::deque<Pair> memory;
  Eigen::VectorXd gradient, next_gradient;
  double value = region.value(x, epsilon, gradient);
  for (int k = 0; k < kSteps; ++k) {
    Eigen::VectorXd direction = -gradient;
    std::vector<double> part(memory.size());
    for (std::size_t i = memory.size(); i-- > 0;) {
      part[i] = memory[i].scale * memory[i].step.dot(direction);
      direction -= part[i] * memory[i].change;
    }
    if (!memory.empty()) direction *= memory.back().step.dot(memory.back().change) / memory.back().change.squaredNorm();
    else direction *= 0.1 / std::max(direction.cwiseAbs().maxCoeff(), 1e-300);
    for (std::size_t i = 0; i < memory.size(); ++i)
      direction += (part[i] - memory[i].scale * memory[i].change.dot(direction)) * memory[i].step;
    const double slope = gradient.dot(direction);
    if (!(slope < 0)) return k > 0;
    double share = 1;
    Eigen::VectorXd next;
    double next_value = 0;
    for (int halving = 0;; ++halving) {
      next = x + share * direction;
      next_value = region.value(next, epsilon, next_gradient);
      if (next_value <= value + 1e-4 * share * slope) break;
      if (halving == 25) return k > 0;
      share *= 0.5;
    }
    const Eigen::VectorXd step = next - x, change = next_gradient - gradient;
    if (const double along = step.dot(change); along > 1e-12 * step.norm() * change.norm()) {
      memory.push_back({step, change, 1 / along});
      if (memory.size() > kMemory) memory.pop_front();
    }
    const bool is_done = value - next_value < 1e-6 * value;
    x = std::move(next);
    gradient.swap(next_gradient);
    value = next_value;
    if (is_done) return true;
  }
  return true;
}

}  // namespace

std::vector<int> tets_inside_out(const Eigen::MatrixX3d& V, const Eigen::MatrixX4i& T) {
  std::vector<int> tets;
  for (int t = 0; t < int(T.rows()); ++t)
    if (!(signed_volume(V, T.row(t)) > 0)) tets.push_back(t);
  return tets;
}

std::int64_t untangle(Eigen::MatrixX3d& V, const Eigen::MatrixX3d& rest, const Eigen::MatrixX4i& T,
                      const std::vector<bool>& fixed) {
  const std::vector<int> wrong = tets_inside_out(V, T);
  if (wrong.empty()) return 0;
  Region region(V, rest, T, wrong, fixed);
  Eigen::VectorXd x(3 * std::ssize(region.nodes()));
  for (std::size_t i = 0; i < region.nodes().size(); ++i) x.segment<3>(3 * i) = V.row(region.nodes()[i]).transpose();
  std::int64_t fewest = std::ssize(wrong);
  int since = 0;  // rounds since the number of wrong tets fell
  for (int round = 0; round < kRounds; ++round) {
    const auto [least, count] = region.least(x);
    since = count < fewest ? 0 : since + 1;
    fewest = std::min(fewest, count);
    if (count == 0 || since == kPatience) break;
    const double epsilon = std::sqrt(1e-8 + 0.04 * least * least);
    if (!descend(region, x, epsilon)) break;
  }
  for (std::size_t i = 0; i < region.nodes().size(); ++i) V.row(region.nodes()[i]) = x.segment<3>(3 * i).transpose();
  return std::ssize(tets_inside_out(V, T));
}

}  // namespace limber
