// SPDX-License-Identifier: AGPL-3.0-or-later
// Contact: where parts of the skin come nearer than a few millimetres, a barrier pushes them apart, and no step takes
// them through each other [Li, Ferguson, Schneider, Langlois, Zorin, Panozzo, Jiang & Kaufman, Incremental Potential
// Contact, SIGGRAPH 2020]. As long as the skin did not cross itself at the start, it never does. Over each pair of a
// point and a triangle, or of two edges (contact_surface.h), d apart:
//   c A H b(d / h),   b(t) = -(t - 1)^2 ln t below 1, else 0
// with c in kPa and A the mean area of skin around a node (half of it for edges). h is the thickness H, but at most
// half of what the pair is apart at rest: so nothing pushes at rest, however close the skin's triangles are; and small
// triangles, whose folds would close soonest, push as hard as large ones. Between two edges the energy fades out as
// they become parallel, where the way between them jumps.
//
// Air is not meshed for it (as in Mueller et al. 2015, Air Meshes): such a mesh cannot tell skin that unfolds from skin
// that meets skin, and slivers of air between neighbouring triangles push where nothing touches.
#pragma once

#include <span>
#include <vector>

#include "core/base/cholesky.h"
#include "core/fem/contact_surface.h"

namespace limber {

struct ContactSettings {
  double barrier_kpa = 40;  // c
  double thickness_mm = 2;  // H
};

class ContactForm {
 public:
  ContactForm() = default;
  // F, rigid  as for ContactSurface
  ContactForm(const Eigen::MatrixX3i& F, const NodePositions& rest, const std::vector<int>& rigid,
              const ContactSettings& settings = {});

  bool empty() const { return surface_.empty(); }
  // What follows is true for places on the way from x to x + limit step.
  void build_broad_phase(const NodePositions& x, const NodePositions& step, double limit);

  struct Bound {
    double length;
    std::array<int, 4> node;  // of the pair that bounds it, -1 none
  };
  // x and step as they are watched, limit at most that.
  Bound largest_step(const NodePositions& x, const NodePositions& step, double limit) const;

  // Asks the pairs watched whose step has `changed` since they were last asked whether all of it would take them too
  // near. x as watched.
  //   changed  #nodes; empty: asks all, about the step that is watched
  void mark_blocking_pairs(const NodePositions& x, const NodePositions& step, const std::vector<char>& changed);
  // visit(nodes) of each that it would.
  template <class Visit>
  void for_blocked(const Visit& visit) const {
    for (std::size_t k = 0; k < watched_.size(); ++k)
      if (blocked_[k]) visit(watched_[k].pair.node);
  }

  double value(const NodePositions& x) const;
  // Also chooses whom add_gradient() and add_curvature() are about: what touches at x.
  void update_active_pairs(const NodePositions& x);
  void add_gradient(NodePositions& gradient) const;
  void add_curvature(std::span<double> values) const;

  // The matrix must know who may touch: who does at x, and who soon may on the way watched. What begins to touch
  // unforeseen pushes weakly: in the matrix each side then meets the other as if that stood still, until it is pressed.
  void add_sparsity(BlockGraphBuilder& graph, std::span<const int> unknown, const NodePositions& x);
  bool assign_nodes(const Cholesky& matrix,
                    std::span<const int> unknown);  // after touch(); false where the matrix must know more

  std::int64_t touching() const { return std::ssize(touching_); }

 private:
  struct Touch {
    ContactPair pair;
    double slope, curvature;                  // of the energy by the distance
    bool pressed;                             // nearer than a share of the thickness
    Eigen::Matrix<double, 3, 4> way, fading;  // of the distance and of the fading by the nodes' places
    double faded;                             // energy without the fading
    std::array<Cholesky::Place, 10> place;    // lower triangle of its nodes, row by row; at -1: not in the matrix
    std::array<int, 4> order;
  };
  struct Fade {
    double value;
    Eigen::Matrix<double, 3, 4> slope;
  };
  struct Watched {
    ContactPair pair;
    double thickness;   // h
    Approach approach;  // from where the way watched begins, by its step
  };
  // Looks for what may come near on a way, as far as that is not known yet.
  void extend_broad_phase(const NodePositions& from, const NodePositions& to);
  double thickness(const ContactPair& pair) const;
  Fade fade(const ContactPair& pair, const NodePositions& x) const;

  ContactSurface surface_;
  NodePositions rest_;
  ContactSettings settings_;
  double scale_ = 0;  // c A H
  // Pairs that are not known keep their thickness, and twice what a node may be off, on these ways.
  NodePositions known_from_, known_to_;
  std::vector<Watched> known_;
  NodePositions watched_from_, watched_to_;  // ends of the way,
  double watched_limit_ = 0;                 // of its step
  std::vector<Watched> watched_;
  std::vector<char> blocked_;  // of those watched
  std::vector<Touch> touching_;
};

}  // namespace limber
