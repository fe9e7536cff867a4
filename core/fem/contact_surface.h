// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the pairs of triangles of a surface that come near each other while its nodes move, and how far the nodes may
// move before two triangles touch. All lengths are in mm.
//
// Two triangles first touch where a corner of one meets the inside of the other, or where two edges meet. So the search
// is for pairs of a point and a triangle and for pairs of edges, in a tree of axis-aligned boxes [Gottschalk, Lin &
// Manocha, OBBTree, SIGGRAPH 1996]. The tree stores the bounds of both positions and steps, so that faces that move
// together are excluded early, however far they move. Additive continuous collision detection then finds how far a pair
// may move, by advances that cannot pass a contact [Li, Kaufman & Jiang, Codimensional Incremental Potential Contact,
// SIGGRAPH 2021].
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
  std::array<int, 4> node;  // a point and a triangle's three corners, or the ends of one edge and of another
  Kind kind;
};

// The shortest line between the two parts of a pair (point and triangle, or two edges): its length `distance`, and its
// direction n = (sum of weight_a x_a) / distance. The derivative of the distance by the position of node a is weight_a
// n.
struct NearestPoints {
  double distance;
  Eigen::Vector4d weight;
  Eigen::Vector3d direction;  // the direction n; zero if the two parts touch
};
NearestPoints nearest_points(const ContactPair& pair, const NodePositions& x);

// The distance `apart` of a pair's two parts at x, and an upper limit `motion` on how far a whole step can move the
// parts towards each other; mm.
struct Approach {
  double apart, motion;
};
Approach approach(const ContactPair& pair, const NodePositions& x, const NodePositions& step);
double motion(const ContactPair& pair, const NodePositions& step);

// Returns the largest share of `step`, up to `limit`, after which at least half of the pair's distance is left (half of
// `near` if the pair is further apart than `near`). The result may be slightly too small. If the result is `limit`,
// only a quarter of the distance is guaranteed. A smaller kept share, such as a tenth, would let folds close faster
// than the barrier can open them, and Newton's method would soon have no possible step.
double largest_step(const ContactPair& pair, const Approach& approach, const NodePositions& x,
                    const NodePositions& step, double limit, double near = INFINITY);
// Returns true if the whole step would bring the pair nearer than largest_step() allows, or if the test cannot exclude
// this.
bool is_too_far(const ContactPair& pair, const Approach& approach, const NodePositions& x, const NodePositions& step,
                double near);

class ContactSurface {
 public:
  ContactSurface() = default;
  //   F      #F triangles of a surface
  //   rest   #V positions
  //   rigid  #V: nodes with the same number, 0 or more, never move relative to each other; -1: free
  ContactSurface(const Eigen::MatrixX3i& F, const NodePositions& rest, const std::vector<int>& rigid);

  bool empty() const { return faces_.empty(); }
  // Defines which pairs count as near: those whose distance is less than reach + margin and also less than
  // of_rest * (their distance at rest) + margin. Lengths in mm.
  struct Nearness {
    double reach, of_rest = INFINITY, margin = 0;
  };
  // Returns the pairs without a common node that may come near (Nearness) during the motion from x to x + limit * step,
  // each pair once. The result does not depend on the number of threads.
  //   asked  #V: 1 for nodes of interest; only pairs with such a node are returned. Empty: all pairs
  std::vector<ContactPair> near(const NodePositions& x, const NodePositions& step, double limit,
                                const Nearness& nearness, const std::vector<char>& asked = {}) const;

 private:
  struct Face {
    std::array<int, 3> node;
    std::uint8_t own_nodes, own_edges;  // bit k: 1 if this face tests its corner k; its edge from corner k to k + 1
  };
  struct Branch {
    std::int32_t begin, end;  // range of the faces below this node of the tree
    std::int32_t right;       // index of the right child (the left child is the next branch); 0: a leaf
  };
  void grow(std::vector<int>& order, const std::vector<Eigen::Vector3d>& centre, int begin, int end);

  std::vector<Face> faces_;  // all faces, in the order of the tree's leaves
  std::vector<Branch> tree_;
  NodePositions rest_;
  std::vector<int> rigid_;
};

}  // namespace limber
