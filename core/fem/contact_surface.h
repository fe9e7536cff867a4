// SPDX-License-Identifier: AGPL-3.0-or-later
// Which parts of a surface come near each other while its nodes move, and how far they may move before they touch.
//
// Two triangles meet first in a corner of one and the inside of the other, or in an edge of each. So a surface is
// watched by such pairs, found in a tree of boxes [Gottschalk, Lin & Manocha, OBBTree, SIGGRAPH 1996, with boxes along
// the axes] that holds places and steps: what moves together stays apart and is left out early, however far it moves.
// How far a pair may go is found by steps that cannot pass a contact [Li, Kaufman & Jiang, Codimensional Incremental
// Potential Contact, SIGGRAPH 2021: additive continuous collision detection]. mm.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/fem/node_positions.h"

namespace limber {

struct ContactPair {
  enum class Kind : std::uint8_t { PointTriangle, EdgeEdge };
  std::array<int, 4> node;  // the point, then the triangle; or two of one edge, then two of the other
  Kind kind;
};

// The shortest way between the two parts: `distance` long, along n = sum of weight_a x_a / distance. Its change with
// the nodes is weight_a n.
struct NearestPoints {
  double distance;
  Eigen::Vector4d weight;
  Eigen::Vector3d direction;  // n; zero where the parts touch
};
NearestPoints nearest_points(const ContactPair& pair, const NodePositions& x);

// What two parts are apart at x, and the most that they come towards each other by a step.
struct Approach {
  double apart, motion;
};
Approach approach(const ContactPair& pair, const NodePositions& x, const NodePositions& step);
double motion(const ContactPair& pair, const NodePositions& step);

// How much of `step`, at most `limit`, a pair may take and keep half of its distance, or half of `near` where it is
// further apart: maybe a little less, and where that is `limit` itself a quarter is sure to be kept. (With a tenth,
// folds close faster than what pushes them open can tell, and Newton's method has then no room left to move in.)
double largest_step(const ContactPair& pair, const Approach& approach, const NodePositions& x,
                    const NodePositions& step, double limit, double near = INFINITY);
// Whether it keeps less on the whole step, or as good as less.
bool is_too_far(const ContactPair& pair, const Approach& approach, const NodePositions& x, const NodePositions& step,
                double near);

class ContactSurface {
 public:
  ContactSurface() = default;
  // F     #F corners of a surface        rest  #V places
  // rigid #V: nodes of the same number, 0 or more, never move against each other; -1 free
  ContactSurface(const Eigen::MatrixX3i& F, const NodePositions& rest, const std::vector<int>& rigid);

  bool empty() const { return faces_.empty(); }
  // What counts as near: less than `reach`, and than the share `of_rest` of what a pair is apart at rest; `margin` more
  // than both.
  struct Nearness {
    double reach, of_rest = INFINITY, margin = 0;
  };
  // Pairs without a common node that may come near on the way from x to x + limit step. Each once, the same for any
  // number of threads.
  //   asked  #V: only pairs with such a node; empty: all
  std::vector<ContactPair> near(const NodePositions& x, const NodePositions& step, double limit,
                                const Nearness& nearness, const std::vector<char>& asked = {}) const;

 private:
  struct Face {
    std::array<int, 3> node;
    std::uint8_t own_nodes, own_edges;  // bits: corner k, edge from corner k to k + 1
  };
  struct Branch {
    std::int32_t begin, end;  // faces
    std::int32_t right;       // of the two below, the left one follows at once; 0: none below
  };
  void grow(std::vector<int>& order, const std::vector<Eigen::Vector3d>& centre, int begin, int end);

  std::vector<Face> faces_;  // in the order of the tree
  std::vector<Branch> tree_;
  NodePositions rest_;
  std::vector<int> rigid_;
};

}  // namespace limber
