// SPDX-License-Identifier: AGPL-3.0-or-later
// Solves for steady heat in the soft voxels of some bricks (8^3 voxels each), for several bones at once:
//   diagonal_i x_i - sum over neighbours j of conductance_ij x_j = source_i
// The diagonal also contains a cell's losses to voxels of fixed temperature and to bricks that are not solved for.
//
// Cells are coloured like a chess board, so that red cells (x + y + z even) have only black neighbours. The red cells
// are eliminated: conjugate gradients run over the black cells alone, which halves every vector [Saad 2003, "Iterative
// Methods for Sparse Linear Systems", 12.4]. One multigrid cycle is the preconditioner: half sweeps of Gauss-Seidel,
// black then red, a correction from coarser levels (core/binding/multigrid.h), then half sweeps red then black.
//
// A brick stores its cells in 512 slots, red before black. Within a colour they are stored row by row along x, four
// cells in a row, which are computed together. The neighbours of these cells along y and z have the same position in
// other rows; their neighbours along x have the same position or the next one. No index lists are needed to find
// neighbours: a cell takes 19 bytes, and 12 more for each bone.
//
// Vectors are floats; sums are doubles over fixed blocks, so that results are the same, bit for bit, for any number of
// threads.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/progress.h"
#include "core/base/zeroed_vector.h"
#include "core/binding/multigrid.h"

namespace limber {

using HeatValues = ZeroedVector<float>;

struct HeatSystem {
  static constexpr int kColour = 256;  // number of slots of one colour in a brick
  static constexpr int kSlots = 2 * kColour;

  // Returns the slot of the voxel at position `in` within its brick, [0, 7] along each axis.
  static int slot_of(const glm::ivec3& in) {
    return kColour * ((in.x + in.y + in.z) & 1) + 4 * (in.y + 8 * in.z) + (in.x >> 1);
  }
  static glm::ivec3 voxel_of(int slot) {
    const int row = (slot & (kColour - 1)) >> 2, y = row & 7, z = row >> 3;
    return {2 * (slot & 3) + ((slot / kColour + y + z) & 1), y, z};
  }

  // Allocates bricks whose lowest voxels are `corners`, in ascending order. The bricks have no cells yet.
  //   beside   for each brick, the indices of its neighbours to -x, +x, -y, +y, -z, +z; -1: none
  //   spacing  voxel size, mm
  void reset(std::vector<glm::ivec3> corners, std::vector<std::array<std::int32_t, 6>> beside,
             const glm::dvec3& spacing);

  std::int64_t brick_count() const { return std::ssize(corners); }
  bool is_cell(std::int64_t brick, int slot) const { return cells[brick][slot >> 6] >> (slot & 63) & 1; }
  void add_cell(std::int64_t brick, int slot, float its_diagonal) {
    cells[brick][slot >> 6] |= std::uint64_t{1} << (slot & 63);
    diagonal[brick * kSlots + slot] = its_diagonal;
  }
  // Returns a reference to the conductance from a red cell to its neighbour in a direction (-x, +x, -y, +y, -z, +z); 0:
  // not linked.
  float& conductance_of_red(std::int64_t brick, int direction, int slot) {
    return conductance[(brick * 6 + direction) * kColour + slot];
  }
  float conductance_of_red(std::int64_t brick, int direction, int slot) const {
    return conductance[(brick * 6 + direction) * kColour + slot];
  }

  glm::dvec3 spacing{1};
  std::vector<glm::ivec3> corners;
  // Indices of the six neighbours of each brick. brick_count(), the index of an empty brick: there is no neighbour.
  std::vector<std::array<std::int32_t, 6>> beside;
  std::vector<std::array<std::uint64_t, 8>> cells;  // bits of each brick's slots that have a cell
  HeatValues conductance;                           // (bricks + the empty brick) x 6 directions x red slots
  HeatValues diagonal;                              // (bricks + the empty brick) x slots; 1 for slots without a cell
};

// The next coarser level of a system, and the coarse cell of each black cell.
struct CoarseHeat {
  CellGraph graph;
  // Index of the coarse cell that contains each black cell, by brick and position in the brick; -1: none.
  ZeroedVector<std::int32_t> parent_of_black;
};
CoarseHeat coarsen(const HeatSystem& system);

// The vectors of a HeatSolver. Each has (bricks + one empty brick) x lanes x 256 values, for the slots of one colour. A
// lane is one right-hand side.
struct HeatVectors {
  HeatValues red_source, red, black;  // right-hand side of the red cells, solutions of red and black cells
  // Vectors of the conjugate gradients on the black cells: the residual r, the search direction p, and `step`, which
  // contains M^-1 r and A p alternately.
  HeatValues residual, search, step;

  // Returns the approximate memory in bytes that a brick takes in these vectors, in the HeatSystem and on the coarser
  // levels.
  static double bytes_of_brick(int lanes) { return 12.0e3 + 7.5e3 * lanes; }
};

class HeatSolver {
 public:
  // Keeps references to the system and the vectors. Every connected component of the system must lose heat to at least
  // one cell of fixed temperature.
  //   lanes  number of right-hand sides, 1 to Multigrid::kMostLanes
  HeatSolver(const HeatSystem& system, int lanes, HeatVectors& vectors);
  ~HeatSolver();

  // Return the array of a vector's values for one brick and one right-hand side (lane), one value for each slot of the
  // colour. The caller writes the values before solve(); all are initially zero.
  float* red_sources(std::int64_t brick, int lane) { return &red_source_[at(brick, lane)]; }
  float* black_sources(std::int64_t brick, int lane) { return &residual_[at(brick, lane)]; }
  float* first_guess_of_blacks(std::int64_t brick, int lane) { return &black_[at(brick, lane)]; }

  // Solves the system. Must be called only once.
  //   residual   relative residual |b - A x| / |b| at which the solve for a right-hand side stops
  MultigridReport solve(double residual, int most_iterations, const Progress& progress = no_progress());

  // Returns the solution at a cell, after solve().
  float temperature(std::int64_t brick, int lane, int slot) const {
    const HeatValues& of_colour = slot < HeatSystem::kColour ? red_ : black_;
    return of_colour[at(brick, lane) + (slot & (HeatSystem::kColour - 1))];
  }

 private:
  using Sums = std::array<double, Multigrid::kMostLanes>;
  using Factors = std::array<float, Multigrid::kMostLanes>;

  std::int64_t at(std::int64_t brick, int lane) const { return (brick * lanes_ + lane) * HeatSystem::kColour; }
  const float* diagonal_of_blacks(std::int64_t brick) const {
    return &system_.diagonal[brick * HeatSystem::kSlots + HeatSystem::kColour];
  }
  template <class Body>
  void for_bricks(const Body& body) const;
  template <class Body>
  Sums sum_over_bricks(const Body& body) const;
  template <bool kRed, class Body>
  void gather(std::int64_t brick, const HeatValues& other, const Body& body) const;

  void relax_reds(const HeatValues& blacks, bool with_sources);
  Sums start();
  Sums precondition();
  Sums apply();

  const HeatSystem& system_;
  const int lanes_;
  CoarseHeat coarse_;  // the next coarser level; its graph was moved into multigrid_
  const Multigrid multigrid_;
  std::unique_ptr<Multigrid::Cycle> cycle_;
  HeatValues &red_source_, &red_, &black_, &residual_, &search_, &step_;
};

}  // namespace limber
