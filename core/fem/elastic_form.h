// SPDX-License-Identifier: AGPL-3.0-or-later
// The elastic energy of a list of tets, with its gradient and Hessian. Tets are grouped in patches (patch_form.h). The
// blocks of a patch's tets are summed first and then added to the matrix once, since adding each tet's blocks to the
// matrix would take most of the time. Threads add to the gradient and the matrix without locks: neighbouring patches
// form chunks, chunks of one colour share no node and run in parallel, and the colours follow one after the other. So
// numbers are always added in the same order, and results do not depend on the number of threads.
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

// The Hessian to compute. Projected, used by solves, leaves out each tet's negative eigenvalues and the term of a
// patch's pressure. (Inside an evenly pressed body the tets' pressure terms cancel, but not after projecting each tet
// separately.) Exact leaves out nothing; only tests and benchmarks use it.
enum class HessianKind { Projected, Exact };

// Ranges of elements (chunks), sorted by colour. Chunks of one colour share no node.
struct ColouredChunks {
  struct Chunk {
    std::int64_t begin, end;
  };
  std::vector<Chunk> chunks;
  std::vector<std::int64_t> colour_first{0};  // #colours + 1: index of the first chunk of each colour

  // Calls body(chunk) for all chunks: one colour after the other, chunks of one colour in parallel.
  void for_each(const std::function<void(const Chunk&)>& body) const;
};

// The stiffness of patches against changes of their volumes. A patch adds the term of_patch G G^T to the Hessian, where
// G is the sum over the patch's tets of of_tet times the derivative of det F by the nodes' positions.
struct PatchStiffness {
  std::span<const double> of_patch, of_tet;  // kPa/mm3 by patch, mm3 by tet; both empty: no such term
};

// Colours chunks of elements so that chunks of one colour share no node.
//   cut       the ends of the chunks, ascending; the last is the number of elements
//   nodes_of  nodes_of(element, visit) calls visit(node) for each node of an element
ColouredChunks colour_chunks(const std::vector<std::int64_t>& cut, int node_count,
                             const std::function<void(std::int64_t, const std::function<void(int)>&)>& nodes_of);

class ElasticForm {
 public:
  struct Tet {
    std::array<int, 4> node;
    // Gradients at rest of the nodes' shape functions, 1/mm: F = sum x_a slope_a^T.
    std::array<Eigen::Vector3d, 4> slope;
    double volume;  // volume at rest, mm3
    TetEnergy energy;
  };

  ElasticForm() = default;
  //   T      #T tets with positive volume at `rest`, in an order that keeps neighbours close
  //   first  #patches + 1: index of the first tet of each patch (PatchOrder). A patch has at least one tet and fewer
  //          than 256 nodes. Empty: every tet is a patch
  ElasticForm(const NodePositions& rest, const Eigen::MatrixX4i& T, const std::vector<TetEnergy>& energy,
              std::vector<std::int64_t> first = {});

  std::int64_t size() const { return std::ssize(tets_); }
  const Tet& tet(std::int64_t t) const { return tets_[t]; }

  void add_sparsity(BlockGraphBuilder& graph, std::span<const int> unknown) const;
  // Finds the positions of every patch's blocks in a matrix in which node v has the block row unknown[v] (-1: v is not
  // an unknown). Changes the order of the nodes within the tets.
  void assign_nodes(const Cholesky& matrix, std::span<const int> unknown);

  // Computes det F of every tet.
  void volume_ratios(const NodePositions& x, std::vector<double>& J) const;
  // Returns the elastic energy; infinite if a tet is inverted.
  //   J  det F of every tet
  double value(const NodePositions& x, const std::vector<double>& J) const;
  // Adds the gradient and the Hessian. assign_nodes() must have been called before.
  //   pressure  the pressure on every tet, kPa; empty: none
  void add_derivatives(const NodePositions& x, std::span<const double> pressure, const PatchStiffness& stiffness,
                       HessianKind curvature, NodePositions& gradient, std::span<double> matrix) const;
  void add_gradient(const NodePositions& x, std::span<const double> pressure, NodePositions& gradient) const;

 private:
  struct Patch {
    std::int64_t begin, end;              // range of the patch's tets in tets_
    std::int64_t node_begin, node_end;    // range of the patch's nodes in node_
    std::int64_t place_begin, place_end;  // range in place_ of the patch's node pairs (lower triangle, row by row)
  };
  class PatchSum;

  std::vector<Tet> tets_;
  std::vector<Patch> patches_;
  // The nodes of each patch. assign_nodes() sorts them: first the nodes that are not unknowns, then the others in the
  // order of the matrix.
  std::vector<int> node_;
  std::vector<std::array<std::uint8_t, 4>> corner_;  // #T: index of each corner among the patch's nodes, ascending
  std::vector<Cholesky::Place> place_;  // position of each node pair's block in the matrix; at == -1: not in the matrix
  ColouredChunks chunks_;               // chunks of neighbouring patches; the elements are patches
};

}  // namespace limber
