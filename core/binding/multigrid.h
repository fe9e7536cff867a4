// SPDX-License-Identifier: AGPL-3.0-or-later
// Solves for steady heat in a graph of cells: A x = b for several right-hand sides at once, where
//   (A x)_i = diagonal_i x_i - sum over neighbours j of conductance_ij x_j
// and the diagonal also contains a cell's losses to cells of fixed temperature (whose heat is in b).
//
// Conjugate gradients, preconditioned by a symmetric multigrid cycle [Braess 1995, "Towards algebraic multigrid for
// elliptic problems of second order"]. Cells are aggregated 2 x 2 x 2 where faces connect them, so that two fingers
// side by side never share a coarse cell. Coarse conductances are the sums over fine faces, halved because the distance
// between centres doubles. The smoother is red-black Gauss-Seidel: a sweep forwards before the coarse correction, and a
// sweep backwards after it.
// Coarse levels are visited twice (a W-cycle), which costs a third more and keeps the number of iterations the same for
// small and large bodies.
//
// Vectors are floats, interleaved (cell x lanes + lane, where a lane is one right-hand side). Sums are doubles over
// fixed blocks, so that results are the same, bit for bit, for any number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/progress.h"
#include "core/base/zeroed_vector.h"

namespace limber {

// A graph of cells and the faces between them. Neighbours always differ in colour, (x + y + z) mod 2; the cells of
// colour 0 (red) come first.
struct CellGraph {
  glm::dvec3 spacing{1};                // size of a cell, mm; only axes with small spacing are coarsened
  ZeroedVector<glm::i16vec3> position;  // position of each cell in units of `spacing`
  std::int32_t red_count = 0;           // number of cells of colour 0
  std::vector<std::int32_t> first;      // #cells + 1: index of each cell's first entry in `neighbour` and `conductance`
  ZeroedVector<std::int32_t> neighbour;
  ZeroedVector<float> conductance;
  std::vector<float> diagonal;  // sum of each cell's conductances to neighbours and to cells of fixed temperature

  std::int64_t size() const { return std::ssize(position); }
};

// Returns 1 for each axis that is to be coarsened: an axis whose spacing is small compared to the others. Coarsening
// makes the spacings of all axes about equal.
glm::i16vec3 coarsened_axes(const glm::dvec3& spacing);
// Factor from the sum of fine conductances to a coarse conductance: 1/2, since the distance between cell centres
// doubles.
constexpr float kCoarseConductance = 0.5f;

// Returns the next coarser graph: sums the conductances between connected cells of the same block (2 x 2 x 2 cells if
// cells are cubes). Losses to cells of fixed temperature count as conduction, so they are halved as well.
//   parent  out: cell of the coarser graph that contains each cell; -1 for a cell that is left out
//   lone    what is done with cells without neighbours
enum class LoneCells { LeaveOut, Keep };
CellGraph coarsen(const CellGraph& fine, std::vector<std::int32_t>& parent, LoneCells lone = LoneCells::LeaveOut);

struct MultigridReport {
  int iterations = 0;
  double residual = 0;  // largest relative residual |b - A x| / |b| of any right-hand side
};

// Throws Error if the residual of a solve is above `residual`.
//   bone  name of the first bone that was solved for
void require_residual(const MultigridReport& solved, double residual, const std::string& bone);

class Multigrid {
 public:
  static constexpr int kMostLanes = 8;

  // Builds the levels. Every connected component of the graph must lose heat to at least one cell of fixed temperature.
  explicit Multigrid(CellGraph finest);

  const CellGraph& finest() const { return levels_.front().graph; }

  // One multigrid cycle, which solves A x = b approximately, for use as a preconditioner. The result is x = M b with a
  // symmetric matrix M. The memory of the cycle is reused in every run.
  struct Cycle {
    virtual ~Cycle() = default;
    // Returns x, which is valid until the next run.
    virtual const ZeroedVector<float>& run() = 0;
    ZeroedVector<float> b;  // right-hand sides, #cells x lanes
  };
  // Makes a cycle that keeps a reference to this multigrid.
  std::unique_ptr<Cycle> cycle(int lanes) const;

  // Solves A x = b by preconditioned conjugate gradients.
  //   b, x       #cells x lanes; x contains the initial guess
  //   lanes      number of right-hand sides, 1 to kMostLanes
  //   residual   relative residual |b - A x| / |b| at which the solve for a right-hand side stops
  MultigridReport solve(ZeroedVector<float> b, ZeroedVector<float>& x, int lanes, double residual, int most_iterations,
                        const Progress& progress = no_progress()) const;

 private:
  struct Level {
    CellGraph graph;
    // For each cell, the cell on the next coarser level that contains it. -1: a cell without neighbours, which the
    // coarser level leaves out. Empty on the coarsest level.
    std::vector<std::int32_t> parent;
    // Index in `red` of the first red cell of each cell of the next coarser level; one more entry marks the end.
    std::vector<std::int32_t> first_red;
    std::vector<std::int32_t> red;  // the red cells in each cell of the next coarser level
  };
  template <int Lanes>
  class Solver;
  template <int Lanes>
  class LanesCycle;

  std::vector<Level> levels_;
  std::vector<double> coarsest_inverse_;  // dense inverse matrix of the coarsest level, row by row
};

}  // namespace limber
