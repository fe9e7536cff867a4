// SPDX-License-Identifier: AGPL-3.0-or-later
// Solves symmetric sparse systems of equations. The matrix consists of 3x3 blocks, one row of blocks per mesh node. The
// method is supernodal Cholesky factorization [Chen, Davis, Hager & Rajamanickam 2008, CHOLMOD] with nested dissection
// of the node graph [Karypis & Kumar 1998, METIS]. A graph is ordered and analysed once, then factorized for any number
// of values. When the next graph differs little, the previous elimination order is adapted to it (elimination_tree.h);
// a new order is computed when the adapted one makes factorizations more than a sixth more expensive.
//
// The factor is computed in single precision (float_factor.h), in half the time and memory, and preconditions conjugate
// gradients in double precision. Where single precision does not suffice, because a matrix is too ill-conditioned, the
// matrix is factorized again in double precision by CHOLMOD. All work runs on one thread, so that results do not depend
// on the number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/elimination_tree.h"

namespace limber {

// Builds the graph of a mesh, in which two nodes are neighbours when they share an element. An element is a list of
// nodes, in which -1 stands for no node.
class BlockGraphBuilder {
 public:
  explicit BlockGraphBuilder(int node_count) : node_count_(node_count) {}
  void add(std::span<const int> element);
  // Returns the graph of all added elements, together with the edges of `base`. `base` is empty or has the same number
  // of nodes.
  BlockGraph build(const BlockGraph& base = {}) const;

 private:
  int node_count_;
  std::vector<std::int64_t> first_{0};
  std::vector<int> node_;
};

class Cholesky {
 public:
  // Location in values() of the 3x3 block of a row node and a column node. The block's entry (row, column), each 0 to
  // 2, is values()[at + column * stride + row].
  struct Place {
    std::int64_t at;
    std::int64_t stride;
  };

  // Computes an elimination order for `graph` and analyses it. Throws Error when memory does not suffice.
  explicit Cholesky(const BlockGraph& graph);
  ~Cholesky();
  Cholesky(Cholesky&&) noexcept;
  Cholesky& operator=(Cholesky&&) noexcept;
  // Analyses another graph. Reuses the memory of the factor, because filling fresh memory would take half the time of a
  // factorization.
  void analyse(const BlockGraph& graph);

  int node_count() const;
  // Returns the node's position in the elimination order. A block is stored only when rank(row node) >= rank(column
  // node). Of a block on the diagonal only the lower triangle is read.
  int rank(int node) const;
  // Returns the location of the block of two nodes; requires rank(row) >= rank(column). The location's `at` is -1 when
  // the nodes differ and are not neighbours in the graph.
  Place place(int row, int column) const;
  // Writes to `places` the locations of the blocks of all pairs of `nodes`: the lower triangle, row by row. The nodes
  // must be sorted by rank. A pair with node -1 (no node) gets `at` = -1.
  void places(std::span<const int> nodes, Place* places) const;

  std::span<double> values();
  void clear();  // sets all values of the matrix to zero

  // Factorizes the matrix. Returns false when the matrix is not positive definite; then solve() must not be called.
  bool factorize();
  // Solves the system in place: `b` holds the right-hand side, then the solution, 3 numbers per node in the graph's
  // order. The error is about 1e-10 of the solution, both measured by the energy x^T A x. Call it after factorize()
  // returned true. Returns false, without a solution, when the matrix turns out not to be positive definite.
  bool solve(std::span<double> b);

  // Returns how many numbers the factor has: 4 bytes each, or 8 if the factorization was repeated in double precision.
  std::int64_t factor_size() const;
  double factor_operations() const;  // approximate number of floating point operations of a factorization
  // Number of factorizations so far that had to be repeated in double precision.
  int repeated_in_double() const;

 private:
  struct Factor;
  std::unique_ptr<Factor> factor_;
};

}  // namespace limber
