// SPDX-License-Identifier: AGPL-3.0-or-later
// Steady heat in a body of cells: solves A x = b for several right sides at once, where
//   (A x)_i = diagonal_i x_i - sum over neighbours j of conductance_ij x_j
// and the diagonal also holds what a cell loses to cells of fixed temperature (its sources stand in b).
//
// Conjugate gradients, preconditioned by a symmetric multigrid cycle [Braess 1995, "Towards algebraic multigrid for
// elliptic problems of second order"]: cells are aggregated 2 x 2 x 2 where faces connect them, so that two fingers
// side by side never share a coarse cell; coarse conductances are the sums over fine faces, halved because the way
// between centres doubles; red-black Gauss-Seidel smooths, forwards before and backwards after the coarse correction.
// Coarse levels are visited twice (a W-cycle), which costs a third more and keeps the number of iterations the same
// for small and large bodies.
//
// Vectors are floats, interleaved (cell x lanes + lane), sums are doubles in fixed blocks: the same bits for any number
// of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/progress.h"

namespace limber {

// Cells and the faces between them. Neighbours always differ in colour, (x + y + z) mod 2; cells of colour 0 come
// first.
struct CellGraph {
  glm::dvec3 spacing{1};               // of the cells, mm: only axes along which they are close are coarsened
  std::vector<glm::i16vec3> position;  // #cells
  std::int32_t red_count = 0;          // cells of colour 0
  std::vector<std::int32_t> first;     // #cells + 1, places in `neighbour` and `conductance`
  std::vector<std::int32_t> neighbour;
  std::vector<float> conductance;
  std::vector<float> diagonal;  // #cells, sum of conductances to neighbours and to fixed cells

  std::int64_t size() const { return std::ssize(position); }
};

// Axes along which cells are so close that heat evens out fast, a 1 each; halving the cells there first keeps the
// others in step.
glm::i16vec3 coarsened_axes(const glm::dvec3& spacing);
// Conductances of a coarser level over the sums of the finer one's: the way between centres doubles.
constexpr float kCoarseConductance = 0.5f;

struct SolveReport {
  int iterations = 0;
  double residual = 0;  // largest over right sides, |b - A x| / |b|
};

class Multigrid {
 public:
  static constexpr int kMostLanes = 8;

  // Every connected piece of the graph must lose heat to some fixed cell.
  explicit Multigrid(CellGraph finest);

  const CellGraph& finest() const { return levels_.front().graph; }

  // Solves A x = b roughly, again and again in the same room: x = M b, where M is symmetric.
  struct Cycle {
    virtual ~Cycle() = default;
    // Returns x, which stands until the next run.
    virtual const std::vector<float>& run() = 0;
    std::vector<float> b;  // #cells x lanes
  };
  // The multigrid is kept as a reference.
  std::unique_ptr<Cycle> cycle(int lanes) const;

  //   b, x       #cells x lanes; x holds the first guess
  //   lanes      right sides, 1 to kMostLanes
  //   residual   where a right side stops, |b - A x| / |b|
  SolveReport solve(std::vector<float> b, std::vector<float>& x, int lanes, double residual, int most_iterations,
                    const Progress& progress = no_progress()) const;

 private:
  struct Level {
    CellGraph graph;
    std::vector<std::int32_t>
        parent;  // #cells, cell of the next level, -1 for cells without neighbours; empty on the coarsest
    std::vector<std::int32_t> first_red;  // #cells of the next level + 1, places in `red`
    std::vector<std::int32_t> red;        // the red cells of each
  };
  template <int Lanes>
  class Solver;
  template <int Lanes>
  class LanesCycle;

  std::vector<Level> levels_;
  std::vector<double> coarsest_inverse_;  // dense, row by row
};

}  // namespace limber
