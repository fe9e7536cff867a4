// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/fem_energy.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/parallel.h"
#include "core/platform/process.h"

namespace limber {

namespace {
// If det F (posed / rest volume) of a tet of flesh is below this, the weak barrier keeps the tet from becoming flat.
constexpr double kWeakBelow = 0.4;
// Addition to the diagonal entries of a node in the Hessian, as a share of the smallest of the three. Flesh that hangs
// by an edge can turn without force, so without the addition the matrix would be singular there, and rounding could
// make it look indefinite.
constexpr double kSteady = 1e-9;
// Lower limit on det F after a step. For a tet whose det F is already below twice this limit, half of its current det F
// is the limit.
constexpr double kKeep = 0.05;

// Returns the CPU time in seconds of this process and of its children that have ended.
double cpu_seconds() { return own_cpu_seconds() + children_cpu_seconds(); }
}  // namespace

CpuTimer::CpuTimer(double& sum) : sum_(sum), start_(cpu_seconds()) {}
CpuTimer::~CpuTimer() { sum_ += cpu_seconds() - start_; }

FemEnergy::FemEnergy(const NodePositions& rest, const Eigen::MatrixX4i& T, const std::vector<TetMaterial>& material,
                     double weak_barrier_kpa, int patch_size)
    : node_count_(int(rest.rows())),
      rest_(rest) {
  std::vector<double> bulk(T.rows()), shear(T.rows());
  for (Eigen::Index t = 0; t < T.rows(); ++t) bulk[t] = patch_bulk(material[t]), shear[t] = material[t].shear_modulus;
  PatchOrder order = grow_patches(rest, T, bulk, shear, patch_size);

  std::vector<TetEnergy> energy(T.rows());
  std::vector<double> ordered_bulk(T.rows()), filled(T.rows());
  flesh_tets_.resize(T.rows(), 4);
  for (Eigen::Index k = 0; k < T.rows(); ++k) {
    const auto t = order.tet[k];
    flesh_tets_.row(k) = T.row(t);
    ordered_bulk[k] = bulk[t];
    filled[k] = material[t].filled;
    // The barrier's energy is c h b(J / h) with h = kWeakBelow and c = weak_barrier_kpa / h, so it is weak_barrier_kpa
    // b(J / h).
    energy[k] = {shear[t], tet_bulk(material[t]), weak_barrier_kpa / kWeakBelow, kWeakBelow};
  }
  flesh_ = ElasticForm(rest, flesh_tets_, energy, order.first);
  patches_ = PatchForm(flesh_, order.first, ordered_bulk, std::move(filled));
  order_ = std::move(order.tet);
  add_inversion_guard(Eigen::MatrixX4i(0, 4));
}

void FemEnergy::set_constraints(PinForm pins, std::vector<int> carried, NodePositions carried_target) {
  if (pins.node != pins_.node || carried != carried_) matrix_.reset();
  pins_ = std::move(pins);
  carried_ = std::move(carried);
  carried_target_ = std::move(carried_target);
}

void FemEnergy::set_pressures(const std::vector<double>& pressure, const std::vector<Eigen::Index>& tet) {
  added_.resize(order_.size());
  for (std::size_t k = 0; k < order_.size(); ++k) added_[k] = pressure[tet[order_[k]]];
}

void FemEnergy::add_inversion_guard(const Eigen::MatrixX4i& guarded) {
  bounded_.resize(flesh_tets_.rows() + guarded.rows(), 4);
  bounded_ << flesh_tets_, guarded;
  keep_.resize(bounded_.rows());
  for (Eigen::Index t = 0; t < bounded_.rows(); ++t)
    keep_[t] = kKeep * determinant(rest_, bounded_(t, 0), bounded_(t, 1), bounded_(t, 2), bounded_(t, 3));
  first_at_.assign(node_count_ + 1, 0);
  for (const int node : bounded_.reshaped()) ++first_at_[node + 1];
  std::partial_sum(first_at_.begin(), first_at_.end(), first_at_.begin());
  tet_at_.resize(4 * bounded_.rows());
  std::vector<int> next(first_at_.begin(), first_at_.end() - 1);
  for (int t = 0; t < int(bounded_.rows()); ++t)
    for (const int node : bounded_.row(t)) tet_at_[next[node]++] = t;
}

void FemEnergy::set_contact(ContactForm contact) {
  matrix_.reset();
  contact_ = std::move(contact);
}

void FemEnergy::prepare(const NodePositions& x) {
  const CpuTimer timer(seconds_.analysis);
  if (matrix_ && contact_.assign_nodes(*matrix_, unknown_)) return;
  if (!matrix_) number();
  BlockGraphBuilder touching(int(node_of_.size()));
  contact_.add_sparsity(touching, unknown_, x);
  const BlockGraph graph = touching.build(graph_);
  {
    const CpuTimer ordering(seconds_.ordering);
    if (matrix_) matrix_->analyse(graph);
    else matrix_ = std::make_unique<Cholesky>(graph);
  }
  ++analyses_;
  flesh_.assign_nodes(*matrix_, unknown_);
  contact_.assign_nodes(*matrix_, unknown_);
}

void FemEnergy::number() {
  // The matrix has rows only for nodes that have springs or flesh and that do not move rigidly with a bone.
  std::vector<char> used(node_count_, 0);
  for (const int node : pins_.node) used[node] = 1;
  for (const int node : flesh_tets_.reshaped()) used[node] = 1;
  for (const int node : carried_) used[node] = 0;
  unknown_.assign(node_count_, -1);
  node_of_.clear();
  for (int i = 0; i < node_count_; ++i)
    if (used[i]) unknown_[i] = int(node_of_.size()), node_of_.push_back(i);

  BlockGraphBuilder graph(int(node_of_.size()));
  flesh_.add_sparsity(graph, unknown_);
  graph_ = graph.build();
}

Cholesky& FemEnergy::matrix() { return *matrix_; }

int FemEnergy::repeated_in_double() const { return matrix_ ? matrix_->repeated_in_double() : 0; }

void FemEnergy::build_broad_phase(const NodePositions& x) {
  if (contact_.empty()) return;
  const CpuTimer timer(seconds_.contact);
  contact_.build_broad_phase(x, NodePositions::Zero(x.rows(), 3), 0);
}

void FemEnergy::find_ratios(const NodePositions& x) {
  if (x.rows() == ratios_at_.rows() && x == ratios_at_) return;
  flesh_.volume_ratios(x, J_);
  ratios_at_ = x;
}

void FemEnergy::find_pressures() {
  patches_.pressures(J_, pressure_);
  for (std::size_t k = 0; k < added_.size(); ++k) pressure_[k] += added_[k];
}

double FemEnergy::value(const NodePositions& x) {
  double sum = 0;
  {
    const CpuTimer timer(seconds_.search);
    find_ratios(x);
    sum = flesh_.value(x, J_) + patches_.value(J_) + pins_.value(x) + slide_.value(x);
    for (std::size_t k = 0; k < added_.size(); ++k) sum += added_[k] * flesh_.tet(std::int64_t(k)).volume * (J_[k] - 1);
    if (load_.rows()) sum -= load_.cwiseProduct(x).sum();
  }
  if (contact_.empty()) return sum;
  const CpuTimer timer(seconds_.contact);
  return sum + contact_.value(x);
}

void FemEnergy::gradient(const NodePositions& x, NodePositions& gradient) {
  find_ratios(x);
  gradient.setZero(node_count_, 3);
  find_pressures();
  flesh_.add_gradient(x, pressure_, gradient);
  contact_.update_active_pairs(x);
  contact_.add_gradient(gradient);
  pins_.add_gradient(x, gradient);
  slide_.add_gradient(x, gradient);
  if (load_.rows()) gradient -= load_;
}

ContactForm::ObjectForces FemEnergy::object_forces(const NodePositions& x) {
  contact_.update_active_pairs(x);
  return contact_.object_forces();
}

void FemEnergy::assemble(const NodePositions& x, HessianKind curvature, NodePositions& gradient) {
  const CpuTimer timer(seconds_.assembly);
  find_ratios(x);
  gradient.setZero(node_count_, 3);
  matrix_->clear();
  const auto values = matrix_->values();
  find_pressures();
  flesh_.add_derivatives(x, pressure_, patches_.stiffness(), curvature, gradient, values);
  contact_.add_gradient(gradient);
  contact_.add_curvature(values);
  pins_.add_gradient(x, gradient);
  slide_.add_gradient(x, gradient);
  if (load_.rows()) gradient -= load_;
  pins_.add_curvature(*matrix_, unknown_, values);
  slide_.add_curvature(x, curvature, *matrix_, unknown_, values);
}

bool FemEnergy::newton_step(const NodePositions& x, HessianKind curvature, NodePositions& step, double& slope,
                            const NodePositions* towards, double damping) {
  {
    const CpuTimer timer(seconds_.contact);
    contact_.update_active_pairs(x);
  }
  prepare(x);
  NodePositions gradient;
  assemble(x, curvature, gradient);
  step.setZero(node_count_, 3);
  for (std::size_t k = 0; k < carried_.size(); ++k) step.row(carried_[k]) = carried_target_.row(k) - x.row(carried_[k]);
  contact_.add_push(step, unknown_, gradient);
  right_side_.resize(3 * node_of_.size());
  for (int k = 0; k < int(node_of_.size()); ++k) {
    const Cholesky::Place own = matrix_->place(k, k);
    double* diagonal = matrix_->values().data() + own.at;
    const double least = std::min({diagonal[0], diagonal[own.stride + 1], diagonal[2 * own.stride + 2]}),
                 steady = kSteady * least;
    for (int c = 0; c < 3; ++c) {
      diagonal[c * own.stride + c] += steady + damping * least;
      right_side_[3 * k + c] = (towards ? steady * (*towards)(node_of_[k], c) : 0) - gradient(node_of_[k], c);
    }
  }

  const CpuTimer timer(seconds_.factorization);
  ++factorizations_;
  if (!matrix_->factorize() || !matrix_->solve(right_side_)) return false;

  slope = 0;
  for (std::size_t k = 0; k < node_of_.size(); ++k) {
    for (int c = 0; c < 3; ++c) step(node_of_[k], c) = right_side_[3 * k + c];
    slope -= gradient.row(node_of_[k]).dot(step.row(node_of_[k]));
  }
  return true;
}

FemEnergy::Bound FemEnergy::largest_step(const NodePositions& x, const NodePositions& step, double limit) {
  Bound bound{limit};
  {
    const CpuTimer timer(seconds_.search);
    const StepBound tets = limber::largest_step(bounded_, x, step, limit, keep_);
    bound.length = tets.length;
    if (tets.tet >= 0) {
      bound.obstacle = tets.tet < flesh_tets_.rows() ? Obstacle::Flesh : Obstacle::Guarded;
      std::copy_n(bounded_.row(tets.tet).begin(), 4, bound.node.begin());
    }
  }
  if (contact_.empty()) return bound;
  const CpuTimer timer(seconds_.contact);
  // Searches skin pairs along the whole step even if tets limit the step to a shorter length, since limit_step() needs
  // all pairs.
  contact_.build_broad_phase(x, step, std::max(bound.length, std::min(limit, 1.0)));
  if (const auto free = contact_.largest_step(x, step, bound.length); free.length < bound.length)
    bound = {free.length, Obstacle::Contact, free.node};
  return bound;
}

NodePositions FemEnergy::limit_step(const NodePositions& x, NodePositions step, const std::vector<char>& fixed) {
  // A tet counts as flattened if the step leaves less than the share kBorne of its volume, or less than kBeyond times
  // the volume that largest_step() leaves. These limits are stricter than those of largest_step(), so that
  // largest_step() does not have to shorten the smoothed step.
  constexpr double kBorne = 0.2;
  constexpr double kBeyond = 1.2;
  constexpr int kRounds = 40;
  // Number of rounds after which pairs of skin are searched again. Pairs that are missed until then still limit the
  // step, since largest_step() makes its own search.
  constexpr int kSeen = 20;
  const CpuTimer timer(seconds_.search);
  const auto& T = bounded_;
  NodePositions sum(x.rows(), 3), there = x + step;
  // asked: the tets that the step may flatten. nodes: the nodes whose step is smoothed; count: for each node, the
  // number of tets and pairs that smooth it.
  std::vector<int> count(x.rows(), 0), nodes, asked(T.rows());
  std::iota(asked.begin(), asked.end(), 0);
  std::vector<char> flattened(T.rows(), 0), changed;
  for (int round = 0; round < kRounds; ++round) {
    parallel_for(std::ssize(asked), 4096, [&](std::int64_t begin, std::int64_t end) {
      for (auto k = begin; k < end; ++k) {
        const int t = asked[k];
        const double before = determinant(x, T(t, 0), T(t, 1), T(t, 2), T(t, 3));
        flattened[t] = determinant(there, T(t, 0), T(t, 1), T(t, 2), T(t, 3)) <
                       std::max(kBorne * before, kBeyond * std::min(0.5 * before, keep_[t]));
      }
    });
    std::erase_if(asked, [&](int t) { return !flattened[t]; });
    const auto smooth = [&](const auto& element) {
      Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
      for (const int v : element) mean += 0.25 * step.row(v);
      for (const int v : element) {
        if (!fixed.empty() && fixed[v]) continue;
        if (count[v]++ == 0) nodes.push_back(v), sum.row(v).setZero();
        sum.row(v) += mean;
      }
    };
    for (const int t : asked) smooth(std::array{T(t, 0), T(t, 1), T(t, 2), T(t, 3)});
    if (!contact_.empty()) {
      if (round % kSeen == 0) {
        contact_.build_broad_phase(x, step, 1);
        changed.clear();
      }
      contact_.mark_blocking_pairs(x, step, changed);
      contact_.for_blocked(smooth);
    }
    if (nodes.empty()) break;
    changed.assign(x.rows(), 0);
    for (const int v : nodes) {
      step.row(v) = 0.5 * step.row(v) + 0.5 / count[v] * sum.row(v);
      there.row(v) = x.row(v) + step.row(v);
      count[v] = 0;
      changed[v] = 1;
      for (int k = first_at_[v]; k < first_at_[v + 1]; ++k)
        if (!flattened[tet_at_[k]]) flattened[tet_at_[k]] = 1, asked.push_back(tet_at_[k]);
    }
    std::sort(asked.begin(), asked.end());
    nodes.clear();
  }
  return step;
}

double FemEnergy::min_ratio(const NodePositions& x) const {
  std::vector<double> J;
  flesh_.volume_ratios(x, J);
  return J.empty() ? 1 : *std::min_element(J.begin(), J.end());
}

}  // namespace limber
