// SPDX-License-Identifier: AGPL-3.0-or-later
// All that a step's shape is the least energy of: flesh (elastic_form.h) with its patches (patch_form.h), the springs
// of the bones (pin_form.h), and with contact what keeps skins apart (contact_form.h); and the matrix of its curvature.
// Nodes deep in a bone, whose tets all belong to that bone alone, are no unknowns: they go where the bone goes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/fem/contact_form.h"
#include "core/fem/elastic_form.h"
#include "core/fem/material.h"
#include "core/fem/patch_form.h"
#include "core/fem/pin_form.h"
#include "core/fem/step_bound.h"

namespace limber {

// Nothing of the solver but its cost, in CPU seconds of all threads. `ordering`: of the analysis, what is CHOLMOD's.
struct FemSeconds {
  double contact = 0, analysis = 0, ordering = 0, assembly = 0, factorization = 0, search = 0, total = 0;

  FemSeconds& operator+=(const FemSeconds& other) {
    contact += other.contact, analysis += other.analysis, ordering += other.ordering, assembly += other.assembly;
    factorization += other.factorization, search += other.search, total += other.total;
    return *this;
  }
};

// Adds the CPU time of the process, while it lives, to a sum.
class CpuTimer {
 public:
  explicit CpuTimer(double& sum);
  ~CpuTimer();
  CpuTimer(const CpuTimer&) = delete;
  CpuTimer& operator=(const CpuTimer&) = delete;

 private:
  double& sum_;
  double start_;
};

class FemEnergy {
 public:
  // Flesh: T and material of the tets that deform, #T each. weak_barrier_kpa ends the oscillation of single tets near J
  // 0.
  FemEnergy(const NodePositions& rest, const Eigen::MatrixX4i& T, const std::vector<TetMaterial>& material,
            double weak_barrier_kpa, int patch_size = 8);

  // Springs, and what moves without being asked: `carried` nodes go to `carried_target`. Keeps the matrix when the
  // nodes are those of the last call.
  void set_constraints(PinForm pins, std::vector<int> carried, NodePositions carried_target);
  // Volume that must not invert although it costs nothing.
  void add_inversion_guard(const Eigen::MatrixX4i& guarded);
  void set_contact(ContactForm contact);

  int node_count() const { return node_count_; }

  // Energy and derivatives know who may touch on one way: that of the last largest_step() or yielding(). Elsewhere this
  // comes first, whose way is x alone.
  void build_broad_phase(const NodePositions& x);
  // Infinite where a tet is inverted.
  double value(const NodePositions& x);
  void gradient(const NodePositions& x, NodePositions& gradient);
  // The Newton step at x: false when the curvature is not positive definite. Also says what the energy falls by along
  // it, to first order (above 0).
  //   towards  where nothing holds a node, as a flap that hangs by two nodes, it takes this step; none: it stays
  bool newton_step(const NodePositions& x, HessianKind curvature, NodePositions& step, double& slope,
                   const NodePositions* towards = nullptr);
  enum class Obstacle { None, Flesh, Guarded, Contact };
  struct Bound {
    double length = 1;  // of the step
    Obstacle obstacle = Obstacle::None;
    std::array<int, 4> node{-1, -1, -1, -1};  // corners of the tet that bounds it, or the nodes of two parts of skin
  };
  Bound largest_step(const NodePositions& x, const NodePositions& step, double limit);

  // The step where it would flatten tets, or take parts of the skin too near each other, made smoother, until it does
  // not or rounds are over: what moves all alike keeps its volume and its distances.
  //   fixed  #nodes: 1 for those whose step stays; empty: none
  NodePositions limit_step(const NodePositions& x, NodePositions step, const std::vector<char>& fixed);

  double min_ratio(const NodePositions& x) const;                   // smallest det F of flesh
  const Eigen::MatrixX4i& volume_tets() const { return bounded_; }  // all that must stay positive: flesh, guarded

  Cholesky& matrix();  // of the last newton_step()
  int factorizations() const { return factorizations_; }
  int analyses() const { return analyses_; }  // of the matrix's pattern, which contact changes
  FemSeconds& seconds() { return seconds_; }

 private:
  void prepare(const NodePositions& x);
  void number();
  void find_ratios(const NodePositions& x);
  void assemble(const NodePositions& x, HessianKind curvature, NodePositions& gradient);

  int node_count_;
  NodePositions rest_;
  std::vector<double> keep_;  // of bounded_, as for largest_step
  Eigen::MatrixX4i flesh_tets_, bounded_;
  std::vector<int> first_at_,
      tet_at_;  // of bounded_, those around each node: tet_at_[first_at_[v] .. first_at_[v + 1])
  ElasticForm flesh_;
  PatchForm patches_;
  PinForm pins_;
  ContactForm contact_;
  std::vector<int> carried_;
  NodePositions carried_target_;

  std::vector<int> unknown_;  // #nodes: row of blocks in the matrix, -1 none
  std::vector<int> node_of_;  // #rows
  BlockGraph graph_;          // of flesh and its patches
  std::unique_ptr<Cholesky> matrix_;
  std::vector<double> J_, pressure_, right_side_;
  NodePositions ratios_at_;  // that J_ is of
  int factorizations_ = 0, analyses_ = 0;
  FemSeconds seconds_;
};

}  // namespace limber
