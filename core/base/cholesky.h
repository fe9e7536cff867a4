// SPDX-License-Identifier: AGPL-3.0-or-later
// Solves symmetric sparse systems of 3x3 blocks, one row of blocks per node of a mesh, by supernodal Cholesky
// factorization [Chen, Davis, Hager & Rajamanickam 2008, CHOLMOD] with nested dissection of the node graph [Karypis &
// Kumar 1998, METIS]. Ordered and analysed once per graph, factorized for as many values as one likes; for a graph that
// is much like the one before the order is mended (elimination_tree.h), and found anew when that has made
// factorizations a quarter dearer. Works on one thread, so that its results do not depend on how many there are.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/elimination_tree.h"

namespace limber {

// The graph in which the nodes of every element meet. Elements are `size` nodes each, -1 is no node.
class BlockGraphBuilder {
 public:
  explicit BlockGraphBuilder(int node_count) : node_count_(node_count) {}
  void add(std::span<const int> element);
  // What is in `base` (of as many nodes, or empty) meets too.
  BlockGraph build(const BlockGraph& base = {}) const;

 private:
  int node_count_;
  std::vector<std::int64_t> first_{0};
  std::vector<int> node_;
};

class Cholesky {
 public:
  // Where the block of two nodes lies in values(): entry (row, column) at `at` + column * `stride` + row.
  struct Place {
    std::int64_t at;
    std::int64_t stride;
  };

  // throws Error when memory does not suffice
  explicit Cholesky(const BlockGraph& graph);
  ~Cholesky();
  Cholesky(Cholesky&&) noexcept;
  Cholesky& operator=(Cholesky&&) noexcept;
  // For another graph, in the memory that the factor has: touching as much anew costs half of a factorization.
  void analyse(const BlockGraph& graph);

  int node_count() const;
  // Of the ordering that keeps the factor sparse. Only blocks whose row node comes at or after their column node are
  // stored; of a node's own block only the lower triangle is read.
  int rank(int node) const;
  // row, column  nodes with rank(row) >= rank(column); at -1 where they neither are the same nor meet in the graph
  Place place(int row, int column) const;
  // Of all pairs of some nodes, whose ranks rise, to `places`: the lower triangle row by row. Where one is -1, no node,
  // at is -1.
  void places(std::span<const int> nodes, Place* places) const;

  std::span<double> values();
  void clear();  // all values to zero

  // False when the matrix is not positive definite: nothing to solve with then.
  bool factorize();
  // Solves in place: 3 numbers per node, in the graph's own order. After a factorize() that was true.
  void solve(std::span<double> b);

  std::int64_t factor_size() const;  // numbers in the factor, 8 bytes each
  double factor_operations() const;  // floating point operations of a factorization, about

 private:
  struct Factor;
  std::unique_ptr<Factor> factor_;
};

}  // namespace limber
