// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/cell_interpolation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/parallel.h"

namespace limber {

namespace {
constexpr std::int64_t kGrain = 64;  // number of bricks in one block of a parallel loop
// A shorter distance between the centres of linked cells, or from a centre to a bone, counts as this, voxels.
constexpr float kLeastDistance = 0.5f;

// Index offset along each axis in a cube of 3 x 3 x 3 values, and the index of the cube's middle.
constexpr std::array<int, 3> kStep{1, 3, 9};
constexpr int kMiddle = 13;

constexpr int face_of(int direction) { return kMiddle + (direction & 1 ? 1 : -1) * kStep[direction >> 1]; }

using Cube = std::array<float, 27>;

class BrickInterpolation {
 public:
  BrickInterpolation(const TissueVoxels& tissue, const HeatCells& cells, const CellTemperatures& temperatures,
                     BestFour& best)
      : tissue_(tissue),
        cells_(cells),
        temperatures_(temperatures),
        best_(best) {}

  void run(std::int64_t brick) {
    // Sorts the brick's voxels by cell.
    const std::int32_t count = cells_.cell_count(brick);
    from_.assign(count + 1, 0);
    tissue_.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3&) {
      if (const std::uint16_t number = cells_.number_in_brick[place]; number != HeatCells::kNoCell) ++from_[number + 1];
    });
    for (std::int32_t k = 0; k < count; ++k) from_[k + 1] += from_[k];
    next_.assign(from_.begin(), from_.end() - 1);
    tissue_.for_each(brick, brick + 1, [&](std::int64_t place, const glm::ivec3& v) {
      if (const std::uint16_t number = cells_.number_in_brick[place]; number != HeatCells::kNoCell)
        voxels_[next_[number]++] = {place, v};
    });
    for (std::int32_t k = 0; k < count; ++k) interpolate_cell(brick, cells_.cell(brick, k), from_[k], from_[k + 1]);
  }

 private:
  // Returns the cell that is linked to `cell` in a direction (the one with the largest conductance); -1: none.
  std::int32_t linked(std::int32_t cell, int direction) const {
    const CellGraph& graph = cells_.graph;
    glm::i16vec3 wanted = graph.position[cell];
    wanted[direction >> 1] = static_cast<std::int16_t>(wanted[direction >> 1] + (direction & 1 ? 1 : -1));
    std::int32_t found = -1;
    float most = 0;
    for (std::int32_t k = graph.first[cell]; k < graph.first[cell + 1]; ++k)
      if (graph.conductance[k] > most && graph.position[graph.neighbour[k]] == wanted) {
        found = graph.neighbour[k];
        most = graph.conductance[k];
      }
    return found;
  }
  // Returns the cell that is linked to cell a in direction from_a or, if there is none, to cell b in direction from_b;
  // -1: none, or a or b is missing.
  std::int32_t linked_to_both(std::int32_t a, int from_a, std::int32_t b, int from_b) const {
    if (a < 0 || b < 0) return -1;
    const std::int32_t found = linked(a, from_a);
    return found >= 0 ? found : linked(b, from_b);
  }

  // Finds the 26 cells around a cell, as far as links lead to them.
  void find_around(std::int32_t cell) {
    around_.fill(-1);
    around_[kMiddle] = cell;
    for (int direction = 0; direction < 6; ++direction) around_[face_of(direction)] = linked(cell, direction);
    for (int x = 0; x < 2; ++x)
      for (int y = 2; y < 4; ++y) find_edge(x, y);
    for (int z = 4; z < 6; ++z) {
      for (int other = 0; other < 4; ++other) find_edge(other, z);
      for (int x = 0; x < 2; ++x)
        for (int y = 2; y < 4; ++y) {
          const int xy = face_of(x) + face_of(y) - kMiddle, xz = face_of(x) + face_of(z) - kMiddle;
          around_[xy + face_of(z) - kMiddle] = linked_to_both(around_[xy], z, around_[xz], y);
        }
    }
  }
  void find_edge(int a, int b) {
    around_[face_of(a) + face_of(b) - kMiddle] = linked_to_both(around_[face_of(a)], b, around_[face_of(b)], a);
  }

  // Lists the bones that have a temperature in the cell or in a cell around it, and these temperatures.
  void gather_values() {
    bones_.clear();
    for (int k = 0; k < 27; ++k) {
      if (around_[k] < 0) continue;
      for (std::int64_t e = temperatures_.first[around_[k]]; e < temperatures_.first[around_[k] + 1]; ++e)
        value_of(temperatures_.entries[e].bone)[k] = temperatures_.entries[e].value;
    }
  }
  Cube& value_of(std::uint16_t bone) {
    const auto found = std::find(bones_.begin(), bones_.end(), bone);
    const auto at = found - bones_.begin();
    if (found == bones_.end()) {
      bones_.push_back(bone);
      if (values_.size() < bones_.size()) values_.emplace_back();
      values_[at].fill(0);
    }
    return values_[at];
  }

  // Computes the distance from the cell's centre to the value in each of the six directions, along the axis, in voxels:
  // the distance to the linked cell or, without one, to the bone on this side, or the edge length of a cell.
  void find_distances(std::int32_t cell) {
    const glm::vec3 centre = cells_.centre[cell];
    held_.fill({});
    for (std::int32_t s = cells_.side_from[cell]; s < cells_.side_from[cell + 1]; ++s) {
      const HeldSide& side = cells_.sides[s];
      const int axis = side.direction >> 1;
      const float face = static_cast<float>(side.nearest[axis]) + (side.direction & 1 ? -0.5f : 0.5f);
      held_[side.direction].conductance += side.conductance;
      held_[side.direction].distance =
          std::max(held_[side.direction].distance, std::max(std::abs(face - centre[axis]), kLeastDistance));
    }
    for (int direction = 0; direction < 6; ++direction) {
      const int axis = direction >> 1;
      if (const std::int32_t other = around_[face_of(direction)]; other >= 0)
        distance_[direction] = std::max(std::abs(cells_.centre[other][axis] - centre[axis]), kLeastDistance);
      else distance_[direction] = held_[direction].conductance > 0 ? held_[direction].distance : 1;
    }
  }

  // Sets the values in directions without a linked cell: to the bone's temperature at a side that touches bones, else
  // to the cell's own value. Values at edges and corners are extrapolated.
  void fill_gaps(std::int32_t cell, std::uint16_t bone, Cube& value) const {
    for (int direction = 0; direction < 6; ++direction) {
      const int face = face_of(direction);
      if (around_[face] >= 0) continue;
      value[face] = value[kMiddle];
      if (held_[direction].conductance == 0) continue;
      float of_bone = 0;
      for (std::int32_t s = cells_.side_from[cell]; s < cells_.side_from[cell + 1]; ++s)
        if (cells_.sides[s].direction == direction && cells_.sides[s].bone == bone)
          of_bone += cells_.sides[s].conductance;
      value[face] = of_bone / held_[direction].conductance;
    }
    for (int k = 0; k < 27; ++k) {
      if (around_[k] >= 0) continue;
      const std::array<int, 3> offset{k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
      int axes = 0;
      float sum = value[kMiddle];
      for (int axis = 0; axis < 3; ++axis) {
        axes += offset[axis] != 0;
        sum += value[kMiddle + offset[axis] * kStep[axis]] - value[kMiddle];
      }
      if (axes > 1) value[k] = std::clamp(sum, 0.0f, 1.0f);
    }
  }

  void interpolate_cell(std::int64_t brick, std::int32_t cell, int begin, int end) {
    find_around(cell);
    gather_values();
    find_distances(cell);
    for (std::size_t k = 0; k < bones_.size(); ++k) fill_gaps(cell, bones_[k], values_[k]);
    for (int i = begin; i < end; ++i) {
      const auto& [place, voxel] = voxels_[i];
      const glm::vec3 offset = glm::vec3(voxel) - cells_.centre[cell];
      std::array<int, 3> step;
      std::array<float, 3> share;
      for (int axis = 0; axis < 3; ++axis) {
        step[axis] = offset[axis] < 0 ? -kStep[axis] : kStep[axis];
        share[axis] = std::min(1.0f, std::abs(offset[axis]) / distance_[2 * axis + (offset[axis] < 0 ? 0 : 1)]);
      }
      for (std::size_t k = 0; k < bones_.size(); ++k) {
        const Cube& value = values_[k];
        const auto along_x = [&](int at) { return value[at] + share[0] * (value[at + step[0]] - value[at]); };
        const auto along_xy = [&](int at) {
          const float here = along_x(at);
          return here + share[1] * (along_x(at + step[1]) - here);
        };
        const float here = along_xy(kMiddle);
        best_.offer(brick, place, bones_[k], here + share[2] * (along_xy(kMiddle + step[2]) - here));
      }
    }
  }

  // For the sides of a cell that touch bones in one direction: the sum of their conductances, and the largest distance.
  struct Held {
    float conductance = 0, distance = 0;  // distance from the cell's centre to the bone, voxels
  };

  const TissueVoxels& tissue_;
  const HeatCells& cells_;
  const CellTemperatures& temperatures_;
  BestFour& best_;
  // Memory that is reused from cell to cell.
  // Indices in voxels_, for each cell: its first voxel; the entry for its next voxel while voxels are being sorted.
  std::vector<int> from_, next_;
  std::array<std::pair<std::int64_t, glm::ivec3>, 512> voxels_;
  std::array<std::int32_t, 27> around_;  // the 27 cells in and around a cell; -1: no link leads to that cell
  std::array<float, 6> distance_;
  std::array<Held, 6> held_;
  std::vector<std::uint16_t> bones_;
  std::vector<Cube> values_;  // temperature of each of bones_ in the cells around
};
}  // namespace

void interpolate_cells(const TissueVoxels& tissue, const HeatCells& cells, const std::vector<std::int32_t>& except,
                       const CellTemperatures& temperatures, BestFour& best) {
  parallel_for(std::ssize(tissue.bricks()), kGrain, [&](std::int64_t begin, std::int64_t end) {
    BrickInterpolation interpolation(tissue, cells, temperatures, best);
    for (std::int64_t brick = begin; brick < end; ++brick)
      if (!std::binary_search(except.begin(), except.end(), static_cast<std::int32_t>(brick))) interpolation.run(brick);
  });
}

}  // namespace limber
