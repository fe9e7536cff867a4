// SPDX-License-Identifier: AGPL-3.0-or-later
// The contact energy: where parts of the skin come nearer to each other than a few millimetres, a barrier pushes them
// apart, and no step moves them through each other [Li, Ferguson, Schneider, Langlois, Zorin, Panozzo, Jiang & Kaufman,
// Incremental Potential Contact, SIGGRAPH 2020]. If the skin does not cross itself at the start, it never does. A pair
// is a point and a triangle, or two edges (contact_surface.h). At distance d it has the energy
//   c A H b(d / h),   b(t) = -(t - 1)^2 ln t for t < 1, else 0
// with the stiffness c in kPa and the mean area A of skin per node (for a pair of edges, half of that area). H is the
// largest thickness of the barrier. The pair's own thickness h is H, but at most half of the pair's distance at rest.
// So no pair pushes at rest, however close the skin's triangles are. The force depends on the mean area and not on the
// pair's own triangles, so that small triangles, whose folds would close first, push as hard as large ones. The energy
// of two edges fades out as they become parallel, because the shortest line between parallel edges is not unique and
// jumps.
//
// An alternative would be to mesh the air between the parts (Mueller et al. 2015, Air Meshes). But an air mesh cannot
// distinguish skin that unfolds from skin that meets skin, and slivers of air between neighbouring triangles push where
// nothing touches.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "core/base/cholesky.h"
#include "core/fem/contact_surface.h"

namespace limber {

struct ContactSettings {
  double barrier_kpa = 40;  // stiffness c of the barrier
  double thickness_mm = 2;  // distance H below which parts of the skin are pushed apart
  double object_mm = 2;     // distance below which skin is pushed away from an object
  // Number of nodes of the skin; the nodes of objects have higher indices. For a pair of skin and object, the thickness
  // is object_mm.
  int skin_nodes = std::numeric_limits<int>::max();
};

class ContactForm {
 public:
  ContactForm() = default;
  // The constructor finds no pairs; build_broad_phase() finds them.
  //   F      #F triangles of the skin and of objects
  //   rest   #V positions
  //   rigid  #V: nodes with the same number, 0 or more, never move relative to each other; -1: free
  ContactForm(const Eigen::MatrixX3i& F, const NodePositions& rest, const std::vector<int>& rigid,
              const ContactSettings& settings = {});

  bool empty() const { return surface_.empty(); }
  // Finds the pairs that may touch during the motion from x to x + limit * step. All other functions are valid only for
  // positions during that motion.
  void build_broad_phase(const NodePositions& x, const NodePositions& step, double limit);

  struct Bound {
    double length;
    std::array<int, 4> node;  // nodes of the pair that limits the step, -1: none
  };
  // Returns the largest share of `step`, up to `limit`, after which every pair keeps enough of its distance: half of it
  // for near pairs, less for distant ones (largest_step() in contact_surface.h).
  //   x, step, limit  as given to build_broad_phase(); limit may be smaller
  Bound largest_step(const NodePositions& x, const NodePositions& step, double limit) const;

  // Marks the pairs that the whole `step` would bring nearer to each other than largest_step() allows.
  //   x        the positions given to build_broad_phase()
  //   changed  #nodes: 1 for nodes whose step has changed since the last call; only pairs with such a node are tested
  //            again. Empty: all pairs are tested, and `step` must be the step given to build_broad_phase()
  void mark_blocking_pairs(const NodePositions& x, const NodePositions& step, const std::vector<char>& changed);
  // Calls visit(nodes) for each pair that mark_blocking_pairs() has marked.
  template <class Visit>
  void for_blocked(const Visit& visit) const {
    for (std::size_t k = 0; k < watched_.size(); ++k)
      if (blocked_[k]) visit(watched_[k].pair.node);
  }

  double value(const NodePositions& x) const;
  // Finds the pairs that touch at x: those whose distance is less than the barrier's thickness h. add_gradient() and
  // add_curvature() add the derivatives of these pairs' energies.
  void update_active_pairs(const NodePositions& x);
  void add_gradient(NodePositions& gradient) const;
  void add_curvature(std::span<double> values) const;
  // Adds the change of the gradient at the unknown nodes that the motion of the other nodes causes, to first order:
  // flesh yields to objects and to rigid parts of the body that move against it.
  //   step     #nodes: motion of each node; the motion of unknown nodes is ignored
  //   unknown  #nodes: -1 for nodes whose motion is prescribed
  void add_push(const NodePositions& step, std::span<const int> unknown, NodePositions& gradient) const;
  // The forces between skin and objects: the force on each node, mN, and for each node of the skin the index of the
  // object's node that presses it most; -1: none.
  struct ObjectForces {
    NodePositions force;
    std::vector<int> pressed_by;
  };
  ObjectForces object_forces() const;

  // Adds the pairs that touch or nearly touch at x to the matrix's sparsity pattern. If another pair begins to touch,
  // the matrix lacks the blocks that couple the pair's two parts, so each part reacts as if the other did not move.
  // This is accurate enough until the pair's distance is below kPressed thicknesses.
  void add_sparsity(BlockGraphBuilder& graph, std::span<const int> unknown, const NodePositions& x);
  // Finds the positions of the touching pairs' blocks in the matrix. Must be called after update_active_pairs().
  // Returns false if a pair whose distance is below kPressed thicknesses is not in the sparsity pattern, so that the
  // matrix must be analysed again.
  bool assign_nodes(const Cholesky& matrix, std::span<const int> unknown);

  std::int64_t touching() const { return std::ssize(touching_); }
  // Returns the smallest distance of all touching pairs, in thicknesses h; 1 if no pair touches.
  double tightest() const { return tightest_; }

 private:
  struct Touch {
    ContactPair pair;
    double slope, curvature;                  // first and second derivative of the energy by the distance
    bool pressed;                             // true: the distance is below kPressed thicknesses
    Eigen::Matrix<double, 3, 4> way, fading;  // derivatives of the distance and of the fade factor by node positions
    double faded;                             // the pair's energy without its fade factor
    std::array<Cholesky::Place, 10> place;    // blocks of the lower triangle, row by row; at == -1: not in the matrix
    std::array<int, 4> order;                 // indices of the pair's nodes (0 to 3) in the order of the matrix's rows
  };
  struct Fade {
    double value;
    Eigen::Matrix<double, 3, 4> slope;
  };
  struct Watched {
    ContactPair pair;
    double thickness;   // the pair's thickness h, mm
    Approach approach;  // distance at the start of the searched motion, and its largest decrease in a whole step, mm
  };
  // Adds to known_ the pairs that may touch during the motion from -> to and that earlier calls have not found.
  void extend_broad_phase(const NodePositions& from, const NodePositions& to);
  double thickness(const ContactPair& pair) const;
  bool has_object(const ContactPair& pair) const;
  Fade fade(const ContactPair& pair, const NodePositions& x) const;

  ContactSurface surface_;
  NodePositions rest_;
  ContactSettings settings_;
  double scale_ = 0;  // the factor c A H of the energy
  // The pairs found so far, and the motion known_from_ -> known_to_ that was searched. All other pairs stay further
  // apart than their thickness during this motion, even if each node deviates from it by kAbout * H.
  NodePositions known_from_, known_to_;
  std::vector<Watched> known_;
  NodePositions watched_from_, watched_to_;  // start and end of the motion of build_broad_phase()
  double watched_limit_ = 0;                 // the argument `limit` of the last build_broad_phase()
  std::vector<Watched> watched_;             // pairs of known_ that may touch during build_broad_phase()'s motion
  std::vector<char> blocked_;                // 1 for each pair of watched_ that mark_blocking_pairs() marked
  std::vector<Touch> touching_;
  double tightest_ = 1;
};

}  // namespace limber
