// SPDX-License-Identifier: AGPL-3.0-or-later
// Steady heat in the soft voxels of some bricks, solved for several bones at once:
//   diagonal_i x_i - sum over neighbours j of conductance_ij x_j = source_i
// The diagonal also holds what a cell loses to voxels of fixed temperature and to bricks that are left out.
//
// Cells are coloured like a chess board, so that the red ones (x + y + z even) have black neighbours only. Reds are
// eliminated: conjugate gradients run over the blacks alone, which halves every vector [Saad 2003, "Iterative Methods
// for Sparse Linear Systems", 12.4]. One multigrid cycle preconditions them: half sweeps of Gauss-Seidel, black then
// red, a visit to coarser levels (core/binding/multigrid.h), and back, red then black.
//
// A brick holds its cells in 512 slots, the reds before the blacks, and within a colour row by row along x, four a row.
// The four cells of a row are worked on together; their neighbours along y and z have the same place in other rows,
// along x the same or the next. Nothing else is stored to find neighbours: a cell costs 19 bytes, and 12 more for each
// bone.
//
// Vectors are floats, sums are doubles in fixed blocks: the same bits for any number of threads.
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
  static constexpr int kColour = 256;  // slots of one colour in a brick
  static constexpr int kSlots = 2 * kColour;

  // Of a voxel that lies `in` a brick, 0 .. 7 along each axis.
  static int slot_of(const glm::ivec3& in) {
    return kColour * ((in.x + in.y + in.z) & 1) + 4 * (in.y + 8 * in.z) + (in.x >> 1);
  }
  static glm::ivec3 voxel_of(int slot) {
    const int row = (slot & (kColour - 1)) >> 2, y = row & 7, z = row >> 3;
    return {2 * (slot & 3) + ((slot / kColour + y + z) & 1), y, z};
  }

  // Makes room for bricks whose lowest voxels are `corners`, in rising order of bricks, without a cell as yet.
  //   beside   of each brick, the position of its neighbour to -x, +x, -y, +y, -z, +z; -1 where there is none
  //   spacing  mm
  void reset(std::vector<glm::ivec3> corners, std::vector<std::array<std::int32_t, 6>> beside,
             const glm::dvec3& spacing);

  std::int64_t brick_count() const { return std::ssize(corners); }
  bool is_cell(std::int64_t brick, int slot) const { return cells[brick][slot >> 6] >> (slot & 63) & 1; }
  void add_cell(std::int64_t brick, int slot, float its_diagonal) {
    cells[brick][slot >> 6] |= std::uint64_t{1} << (slot & 63);
    diagonal[brick * kSlots + slot] = its_diagonal;
  }
  // From a red cell to its neighbour in a direction as above; 0 where they are not joined.
  float& conductance_of_red(std::int64_t brick, int direction, int slot) {
    return conductance[(brick * 6 + direction) * kColour + slot];
  }
  float conductance_of_red(std::int64_t brick, int direction, int slot) const {
    return conductance[(brick * 6 + direction) * kColour + slot];
  }

  glm::dvec3 spacing{1};
  std::vector<glm::ivec3> corners;
  std::vector<std::array<std::int32_t, 6>> beside;  // brick_count() where there is none: an empty brick
  std::vector<std::array<std::uint64_t, 8>> cells;  // a bit a slot
  HeatValues conductance;                           // bricks + the empty one, 6 directions, red slots
  HeatValues diagonal;                              // bricks + the empty one, slots; 1 without a cell
};

// The next level of a system, and which of its cells each black cell belongs to.
struct CoarseHeat {
  CellGraph graph;
  ZeroedVector<std::int32_t> parent_of_black;  // bricks, black slots; -1 without a cell
};
CoarseHeat coarsen(const HeatSystem& system);

// What a solver works on: bricks + the empty one, lanes, slots of a colour.
struct HeatVectors {
  HeatValues red_source, red, black;  // of reds: b, x; of blacks: x
  HeatValues residual, search, step;  // of blacks: r, p and, by turns, M^-1 r and A p

  // About what a brick takes here, in its system and on the coarser levels.
  static double bytes_of_brick(int lanes) { return 12.0e3 + 7.5e3 * lanes; }
};

class HeatSolver {
 public:
  // The system and the vectors are kept as references. Every connected piece of it must lose heat to something.
  //   lanes  right sides, 1 to Multigrid::kMostLanes
  HeatSolver(const HeatSystem& system, int lanes, HeatVectors& vectors);
  ~HeatSolver();

  // Of one brick and right side, by slot of the colour; all are zero at first.
  float* red_sources(std::int64_t brick, int lane) { return &red_source_[at(brick, lane)]; }
  float* black_sources(std::int64_t brick, int lane) { return &residual_[at(brick, lane)]; }
  float* first_guess_of_blacks(std::int64_t brick, int lane) { return &black_[at(brick, lane)]; }

  // Called once.
  //   residual   where a right side stops, |b - A x| / |b|
  SolveReport solve(double residual, int most_iterations, const Progress& progress = no_progress());

  // After solve().
  float temperature(std::int64_t brick, int lane, int slot) const {
    const HeatValues& of_colour = slot < HeatSystem::kColour ? red_ : black_;
    return of_colour[at(brick, lane) + (slot & (HeatSystem::kColour - 1))];
  }

 private:
  using Sums = std::array<double, Multigrid::kMostLanes>;
  using Factors = std::array<float, Multigrid::kMostLanes>;

  std::int64_t at(std::int64_t brick, int lane) const { return (brick * lanes_ + lane) * HeatSystem::kColour; }
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
  CoarseHeat coarse_;  // its graph is the multigrid's
  const Multigrid multigrid_;
  std::unique_ptr<Multigrid::Cycle> cycle_;
  HeatValues &red_source_, &red_, &black_, &residual_, &search_, &step_;
};

}  // namespace limber
