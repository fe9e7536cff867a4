// SPDX-License-Identifier: AGPL-3.0-or-later
// The total energy that a solve minimises: the energy of flesh (elastic_form.h) with its patches (patch_form.h), of the
// bones' springs (pin_form.h), of flesh that slides along bones (slide_form.h), and of contact (contact_form.h), if it
// is on. FemEnergy also owns the Hessian matrix. Nodes deep in a bone, whose tets all belong to that bone, are not
// unknowns: they move with the bone.
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
#include "core/fem/slide_form.h"
#include "core/fem/step_bound.h"

namespace limber {

// CPU seconds, summed over all threads, that each stage of the solver took. `analysis` includes `ordering`, the time of
// CHOLMOD's fill-reducing ordering.
struct FemSeconds {
  double contact = 0, analysis = 0, ordering = 0, assembly = 0, factorization = 0, search = 0, total = 0;

  FemSeconds& operator+=(const FemSeconds& other) {
    contact += other.contact, analysis += other.analysis, ordering += other.ordering, assembly += other.assembly;
    factorization += other.factorization, search += other.search, total += other.total;
    return *this;
  }
};

// Measures the CPU time that the process uses during the timer's lifetime and adds it to `sum`, in seconds.
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
  // At first, the energy is that of the tets alone. The functions below add springs, contact and a load.
  //   T, material       the tets that deform and their materials, #T each
  //   weak_barrier_kpa  strength of the barrier against det F = 0, which stops single tets from oscillating near 0
  FemEnergy(const NodePositions& rest, const Eigen::MatrixX4i& T, const std::vector<TetMaterial>& material,
            double weak_barrier_kpa, int patch_size = 8);

  // Sets the springs and the nodes that are not unknowns: the nodes `carried` move to `carried_target`. The matrix
  // stays valid if the nodes are the same as in the last call.
  void set_constraints(PinForm pins, std::vector<int> carried, NodePositions carried_target);
  // Adds tets that have no energy but that no step may invert.
  void add_inversion_guard(const Eigen::MatrixX4i& guarded);
  void set_contact(ContactForm contact);
  // Sets the flesh that slides along bones, which begins with the bones at rest.
  void set_slide(SlideForm slide) { slide_ = std::move(slide); }
  // Moves the bones along which flesh slides.
  //   moved  motion that is subtracted from the nodes' positions first (SlideForm::moved); empty: none
  void move_slide(std::vector<RigidTransform> posed_from_rest, NodePositions moved = {}) {
    slide_.posed_from_rest = std::move(posed_from_rest);
    slide_.moved = std::move(moved);
  }
  const SlideForm& slide() const { return slide_; }
  // Sets a constant pressure on each tet that deforms, kPa, beyond the pressures that its material causes. Positive
  // pressure makes the tet smaller.
  //   pressure  pressure[tet[t]] acts on tet t of the constructor's T
  void set_pressures(const std::vector<double>& pressure, const std::vector<Eigen::Index>& tet);
  // Sets a constant force on each node, such as its weight, mN.
  void set_load(NodePositions load) { load_ = std::move(load); }

  int node_count() const { return node_count_; }

  // Prepares contact at the position x. The energy and its derivatives are valid only for positions during the motion
  // that was last given to largest_step() or limit_step(). Call this before evaluating them at any other position.
  void build_broad_phase(const NodePositions& x);
  // Returns the energy at x; infinite if a tet is inverted.
  double value(const NodePositions& x);
  void gradient(const NodePositions& x, NodePositions& gradient);
  // Computes the Newton step at x. Returns false if the Hessian is not positive definite.
  //   slope    out: decrease of the energy along the step, to first order (above 0)
  //   towards  #nodes: the step of nodes that can move without force, such as those of a flap that hangs by two nodes.
  //            Null: these nodes do not move
  //   damping  addition to the diagonal entries of each node in the Hessian, as a share of the smallest of the three.
  //            It shortens steps in directions in which hardly any force acts
  bool newton_step(const NodePositions& x, HessianKind curvature, NodePositions& step, double& slope,
                   const NodePositions* towards = nullptr, double damping = 0);
  enum class Obstacle { None, Flesh, Guarded, Contact };
  struct Bound {
    double length = 1;  // largest share of the step that is allowed
    Obstacle obstacle = Obstacle::None;
    std::array<int, 4> node{-1, -1, -1, -1};  // corners of the tet, or nodes of the contact pair, that limits the step
  };
  Bound largest_step(const NodePositions& x, const NodePositions& step, double limit);

  // Returns the step smoothed around tets that it would flatten and around pairs of skin that it would bring too near
  // to each other. Smoothing makes the steps of the nodes of such a tet or pair more alike, which keeps its volume or
  // distance. Repeats this until no such tets and pairs are left, or for a limited number of rounds.
  //   fixed  #nodes: 1 for nodes whose step stays unchanged; empty: none
  NodePositions limit_step(const NodePositions& x, NodePositions step, const std::vector<char>& fixed);

  // Returns the force on each node, mN, from contact between skin and objects. The broad phase must be valid at x.
  ContactForm::ObjectForces object_forces(const NodePositions& x);

  // Returns the smallest distance of touching parts at the last newton_step(), in thicknesses of the barrier.
  double tightest() const { return contact_.tightest(); }
  double min_ratio(const NodePositions& x) const;                   // returns the smallest det F of all tets of flesh
  const Eigen::MatrixX4i& volume_tets() const { return bounded_; }  // flesh and the tets of add_inversion_guard()

  Cholesky& matrix();  // returns the Hessian of the last newton_step()
  int factorizations() const { return factorizations_; }
  int repeated_in_double() const;             // number of factorizations that single precision was too inexact for
  int analyses() const { return analyses_; }  // number of analyses of the sparsity pattern, which contact changes
  FemSeconds& seconds() { return seconds_; }

 private:
  void prepare(const NodePositions& x);
  void number();
  void find_ratios(const NodePositions& x);
  void find_pressures();
  void assemble(const NodePositions& x, HessianKind curvature, NodePositions& gradient);

  int node_count_;
  NodePositions rest_;
  std::vector<double> keep_;  // #tets of bounded_: six times the volume that a step must leave (step_bound.h), mm3
  Eigen::MatrixX4i flesh_tets_, bounded_;
  // The tets around node v are tet_at_[first_at_[v]] to tet_at_[first_at_[v + 1] - 1].
  std::vector<int> first_at_, tet_at_;
  ElasticForm flesh_;
  PatchForm patches_;
  PinForm pins_;
  SlideForm slide_;
  ContactForm contact_;
  std::vector<std::int64_t> order_;  // index in the constructor's T of each tet of flesh_
  std::vector<double> added_;        // #T: pressure that set_pressures() added; empty: none
  NodePositions load_;               // force on each node, mN; empty: none
  std::vector<int> carried_;
  NodePositions carried_target_;

  std::vector<int> unknown_;  // #nodes: block row in the matrix, -1: not an unknown
  std::vector<int> node_of_;  // #block rows: index of the row's node
  BlockGraph graph_;          // the matrix's sparsity pattern without contact
  std::unique_ptr<Cholesky> matrix_;
  std::vector<double> J_, pressure_, right_side_;
  NodePositions ratios_at_;  // the positions at which J_ was computed
  int factorizations_ = 0, analyses_ = 0;
  FemSeconds seconds_;
};

}  // namespace limber
