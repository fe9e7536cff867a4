// SPDX-License-Identifier: AGPL-3.0-or-later
// The elastic energy of a list of tets with its forces and its curvature. Tets stand in patches (patch_form.h), each of
// which adds to the matrix once: what its tets share is summed before, for most of such a sum is the way to the matrix
// and back. Adding to forces and matrix runs in parallel without a lock: neighbouring patches form chunks, chunks of
// one colour share no node, and colours take turns, so that every sum has one order.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/cholesky.h"
#include "core/fem/node_positions.h"
#include "core/fem/tet_energy.h"

namespace limber {

// Projected: without what is negative in a tet's, and without what a pressure adds to it, which cancels inside an
// evenly pressed body but not once it is projected tet by tet. Solves take the projected one; the exact one is what it
// is checked by.
enum class HessianKind { Projected, Exact };

// Ranges of elements in an order in which ranges of one colour, which share no node, stand together.
struct ColouredChunks {
  struct Chunk {
    std::int64_t begin, end;
  };
  std::vector<Chunk> chunks;
  std::vector<std::int64_t> colour_first{0};  // #colours + 1

  // body(chunk) for all, in parallel within a colour.
  void for_each(const std::function<void(const Chunk&)>& body) const;
};

// What every patch adds to the curvature: of_patch G G^T, where G is the sum of of_tet times the change of the tet's
// det F with the nodes.
struct PatchStiffness {
  std::span<const double> of_patch, of_tet;  // kPa/mm3, mm3; both empty: nothing
};

// nodes_of(element, visit) calls visit(node) for its nodes; `cut` holds where chunks may end, rising, the number of
// elements last.
ColouredChunks colour_chunks(const std::vector<std::int64_t>& cut, int node_count,
                             const std::function<void(std::int64_t, const std::function<void(int)>&)>& nodes_of);

class ElasticForm {
 public:
  struct Tet {
    std::array<int, 4> node;
    std::array<Eigen::Vector3d, 4> slope;  // of the node's linear hat function at rest, 1/mm: F = sum of x_a slope_a^T
    double volume;                         // at rest, mm3
    TetEnergy energy;
  };

  ElasticForm() = default;
  // T      #T corners with positive volume at `rest`, in an order that keeps neighbours close
  // first  #patches + 1: where each begins, as in PatchOrder: of a tet or more, and of less than 256 nodes; empty:
  // every tet is one
  ElasticForm(const NodePositions& rest, const Eigen::MatrixX4i& T, const std::vector<TetEnergy>& energy,
              std::vector<std::int64_t> first = {});

  std::int64_t size() const { return std::ssize(tets_); }
  const Tet& tet(std::int64_t t) const { return tets_[t]; }

  void add_sparsity(BlockGraphBuilder& graph, std::span<const int> unknown) const;
  // Where the blocks of every patch lie in a matrix over unknown[node] (-1: the node is none). Changes the order of
  // tets' nodes.
  void assign_nodes(const Cholesky& matrix, std::span<const int> unknown);

  // det F of every tet.
  void volume_ratios(const NodePositions& x, std::vector<double>& J) const;
  // Infinite where a tet is inverted.
  double value(const NodePositions& x, const std::vector<double>& J) const;
  // After bind().
  //   pressure  of every tet, kPa, or empty
  void add_derivatives(const NodePositions& x, std::span<const double> pressure, const PatchStiffness& stiffness,
                       HessianKind curvature, NodePositions& gradient, std::span<double> matrix) const;
  void add_gradient(const NodePositions& x, std::span<const double> pressure, NodePositions& gradient) const;

 private:
  struct Patch {
    std::int64_t begin, end;              // of its tets
    std::int64_t node_begin, node_end;    // in node_
    std::int64_t place_begin, place_end;  // in place_: lower triangle of node pairs, row by row
  };
  class PatchSum;

  std::vector<Tet> tets_;
  std::vector<Patch> patches_;
  std::vector<int> node_;  // in the order of the matrix once it is known, first those that it has not
  std::vector<std::array<std::uint8_t, 4>> corner_;  // #T: places of a tet's nodes among its patch's, rising
  std::vector<Cholesky::Place> place_;               // at -1: not in the matrix
  ColouredChunks chunks_;                            // of patches
};

}  // namespace limber
