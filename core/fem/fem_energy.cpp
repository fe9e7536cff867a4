// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/fem/fem_energy.h"

#include <algorithm>
#include <cmath>

#include <sys/resource.h>

namespace limber {

namespace {
constexpr double kWeakBelow = 0.4;  // det F of flesh at which the weak barrier begins

// Of this process and of those it has started and seen end (that mesh the air).
double cpu_seconds() {
  double sum = 0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage used{};
    getrusage(who, &used);
    for (const timeval& time : {used.ru_utime, used.ru_stime}) sum += double(time.tv_sec) + 1e-6 * double(time.tv_usec);
  }
  return sum;
}

Eigen::MatrixX4i stacked(const Eigen::MatrixX4i& a, const Eigen::MatrixX4i& b, const Eigen::MatrixX4i& c) {
  Eigen::MatrixX4i all(a.rows() + b.rows() + c.rows(), 4);
  all << a, b, c;
  return all;
}
}  // namespace

CpuTimer::CpuTimer(double& sum) : sum_(sum), start_(cpu_seconds()) {}
CpuTimer::~CpuTimer() { sum_ += cpu_seconds() - start_; }

FemEnergy::FemEnergy(const Places& rest, const Eigen::MatrixX4i& T, const std::vector<TetMaterial>& material, double weak_barrier_kpa, int patch_size)
    : node_count_(int(rest.rows())), guarded_(0, 4) {
  std::vector<double> bulk(T.rows()), shear(T.rows());
  for (Eigen::Index t = 0; t < T.rows(); ++t) bulk[t] = patch_bulk(material[t]), shear[t] = material[t].shear_modulus;
  const PatchOrder order = grow_patches(rest, T, bulk, shear, patch_size);

  std::vector<TetEnergy> energy(T.rows());
  std::vector<double> ordered_bulk(T.rows());
  flesh_tets_.resize(T.rows(), 4);
  for (Eigen::Index k = 0; k < T.rows(); ++k) {
    const auto t = order.tet[k];
    flesh_tets_.row(k) = T.row(t);
    ordered_bulk[k] = bulk[t];
    // A barrier's c h b(J / h): c such that it is as strong as weak_barrier_kpa b(J / h).
    energy[k] = {shear[t], tet_bulk(material[t]), weak_barrier_kpa / kWeakBelow, kWeakBelow};
  }
  flesh_ = ElasticForm(rest, flesh_tets_, energy, {order.first.begin() + 1, order.first.end()});
  patches_ = PatchForm(flesh_, order.first, ordered_bulk, node_count_);
  air_tets_.resize(0, 4);
  bounded_ = flesh_tets_;
}

void FemEnergy::hold(PinForm pins, std::vector<int> carried, Places carried_target) {
  if (pins.node != pins_.node || carried != carried_) matrix_.reset();
  pins_ = std::move(pins);
  carried_ = std::move(carried);
  carried_target_ = std::move(carried_target);
}

void FemEnergy::set_air(ElasticForm air, Eigen::MatrixX4i air_tets, Eigen::MatrixX4i guarded) {
  matrix_.reset();
  air_ = std::move(air);
  air_tets_ = std::move(air_tets);
  guarded_ = std::move(guarded);
  bounded_ = stacked(flesh_tets_, guarded_, air_tets_);
}

void FemEnergy::prepare() {
  if (matrix_) return;
  const CpuTimer timer(seconds_.analysis);
  // Nodes that nothing pulls at are no unknowns either: a matrix has no row for them.
  std::vector<char> used(node_count_, 0);
  for (const int node : pins_.node) used[node] = 1;
  for (const int node : flesh_tets_.reshaped()) used[node] = 1;
  for (const int node : carried_) used[node] = 0;
  unknown_.assign(node_count_, -1);
  node_of_.clear();
  for (int i = 0; i < node_count_; ++i)
    if (used[i]) unknown_[i] = int(node_of_.size()), node_of_.push_back(i);

  BlockGraphBuilder graph(int(node_of_.size()));
  flesh_.connect(graph, unknown_);
  patches_.connect(graph, unknown_);
  air_.connect(graph, unknown_);
  matrix_ = std::make_unique<Cholesky>(graph.build());
  flesh_.bind(*matrix_, unknown_);
  patches_.bind(flesh_, *matrix_, unknown_);
  air_.bind(*matrix_, unknown_);
}

Cholesky& FemEnergy::matrix() {
  prepare();
  return *matrix_;
}

void FemEnergy::ratios(const Places& x) {
  flesh_.volume_ratios(x, J_);
  air_.volume_ratios(x, air_J_);
}

double FemEnergy::value(const Places& x) {
  const CpuTimer timer(seconds_.search);
  ratios(x);
  return flesh_.value(x, J_) + patches_.value(J_) + air_.value(x, air_J_) + pins_.value(x);
}

void FemEnergy::gradient(const Places& x, Places& gradient) {
  ratios(x);
  gradient.setZero(node_count_, 3);
  patches_.pressures(J_, pressure_);
  flesh_.add_gradient(x, pressure_, gradient);
  air_.add_gradient(x, {}, gradient);
  pins_.add_gradient(x, gradient);
}

void FemEnergy::assemble(const Places& x, Curvature curvature, Places& gradient) {
  const CpuTimer timer(seconds_.assembly);
  ratios(x);
  gradient.setZero(node_count_, 3);
  matrix_->clear();
  const auto values = matrix_->values();
  patches_.pressures(J_, pressure_);
  flesh_.add_derivatives(x, pressure_, curvature, gradient, values);
  patches_.add_curvature(flesh_, x, values);
  air_.add_derivatives(x, {}, curvature, gradient, values);
  pins_.add_gradient(x, gradient);
  pins_.add_curvature(*matrix_, unknown_, values);
}

bool FemEnergy::newton_step(const Places& x, Curvature curvature, Places& step, double& slope) {
  prepare();
  Places gradient;
  assemble(x, curvature, gradient);

  const CpuTimer timer(seconds_.factorization);
  ++factorizations_;
  if (!matrix_->factorize()) return false;
  right_side_.resize(3 * node_of_.size());
  for (std::size_t k = 0; k < node_of_.size(); ++k)
    for (int c = 0; c < 3; ++c) right_side_[3 * k + c] = -gradient(node_of_[k], c);
  matrix_->solve(right_side_);

  step.setZero(node_count_, 3);
  for (std::size_t k = 0; k < carried_.size(); ++k) step.row(carried_[k]) = carried_target_.row(k) - x.row(carried_[k]);
  slope = 0;
  for (std::size_t k = 0; k < node_of_.size(); ++k) {
    for (int c = 0; c < 3; ++c) step(node_of_[k], c) = right_side_[3 * k + c];
    slope -= gradient.row(node_of_[k]).dot(step.row(node_of_[k]));
  }
  return true;
}

StepBound FemEnergy::largest_step(const Places& x, const Places& step, double limit) const { return limber::largest_step(bounded_, x, step, limit); }

Eigen::RowVector4i FemEnergy::bounding_tet(const StepBound& bound) const { return bounded_.row(bound.tet); }

FemEnergy::Part FemEnergy::part_of(const StepBound& bound) const {
  if (bound.tet < flesh_tets_.rows()) return Part::Flesh;
  return bound.tet < flesh_tets_.rows() + guarded_.rows() ? Part::Guarded : Part::Air;
}

double FemEnergy::min_ratio(const Places& x) const {
  std::vector<double> J;
  flesh_.volume_ratios(x, J);
  return J.empty() ? 1 : *std::min_element(J.begin(), J.end());
}

double FemEnergy::min_air_ratio(const Places& x) const {
  std::vector<double> J;
  air_.volume_ratios(x, J);
  return J.empty() ? 1 : *std::min_element(J.begin(), J.end());
}

}  // namespace limber
