// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/depth.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>

#include "core/base/parallel.h"
#include "core/platform/memory_pages.h"
#include "core/volume/float_lanes.h"
#include "core/volume/step_lanes.h"

namespace limber {

namespace {

constexpr int kBrick = TissueVoxels::kBrick;
constexpr int kBrickVoxels = TissueDepth::kBrickVoxels;
constexpr int kRows = 4;  // number of rows of eight voxels of a brick that one search handles together

// SIMD register with one voxel of each of the neighbouring lines that are searched at once.
template <class Value>
using Across = std::conditional_t<std::is_same_v<Value, float>, FloatLanes<kRows * kBrick / 4>, StepLanes<kRows>>;

// Returns the squared length of a number of steps of `spacing`, clamped to the largest value of the type.
template <class Value>
Value squared_length(double steps, double spacing) {
  return static_cast<Value>(
      std::min(spacing * spacing * steps * steps, static_cast<double>(std::numeric_limits<Value>::max())));
}

// Parallel lines of voxels through a column of tissue bricks. There is air, with the value zero, beyond both ends.
template <class Value>
struct Lines {
  std::vector<Across<Value>> f;      // the value of each line at each position along the column
  std::vector<Across<Value>> least;  // the least value of each line within each brick
  std::vector<Value> rise;           // rise[n]: squared length of n steps

  Lines(std::size_t bricks, double spacing) : f(bricks * kBrick), least(bricks), rise(bricks * kBrick + 1) {
    for (std::size_t steps = 0; steps < rise.size(); ++steps)
      rise[steps] = squared_length<Value>(static_cast<double>(steps), spacing);
  }

  void find_least() {
    for (std::size_t brick = 0; brick < least.size(); ++brick) {
      least[brick] = f[brick * kBrick];
      for (int i = 1; i < kBrick; ++i) lower(least[brick], f[brick * kBrick + i], 0);
    }
  }
};

// Returns the least squared distance from position i of each line: the minimum over j of f[j] + rise[|i - j|], where
// rise[n] is the squared length of n steps. Skips bricks whose least values are too large to give a smaller result.
template <class Value>
Across<Value> lowest_around(const Lines<Value>& lines, int i) {
  const int own = i / kBrick, bricks = static_cast<int>(lines.least.size());
  const Value* rise = lines.rise.data();
  Across<Value> lowest = lines.f[i];
  lower(lowest, Across<Value>{}, rise[i + 1]);
  lower(lowest, Across<Value>{}, rise[bricks * kBrick - i]);
  const auto visit = [&](int brick) {
    for (int j = brick * kBrick; j < (brick + 1) * kBrick; ++j) lower(lowest, lines.f[j], rise[std::abs(j - i)]);
  };
  visit(own);
  bool below = true, above = true;
  for (int k = 1; below || above; ++k) {
    const int low = own - k, high = own + k, from_low = i - low * kBrick - (kBrick - 1), from_high = high * kBrick - i;
    below = below && low >= 0 && any_above(lowest, rise[from_low]);
    above = above && high < bricks && any_above(lowest, rise[from_high]);
    if (below && any_lower(lines.least[low], rise[from_low], lowest)) visit(low);
    if (above && any_lower(lines.least[high], rise[from_high], lowest)) visit(high);
  }
  return lowest;
}

// Calls body(bricks) for each run of adjacent tissue bricks along the axis. There is air beyond both ends of a run.
template <class Body>
void for_each_column(const TissueVoxels& tissue, int axis, const Body& body) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const glm::ivec3 bricks = tissue.brick_grid();
  parallel_for(std::int64_t{bricks[u]} * bricks[v], 4, [&](std::int64_t begin, std::int64_t end) {
    std::vector<int> column;
    for (auto c = begin; c < end; ++c) {
      glm::ivec3 at(0);
      at[u] = static_cast<int>(c % bricks[u]);
      at[v] = static_cast<int>(c / bricks[u]);
      for (; at[axis] <= bricks[axis]; ++at[axis]) {
        const int brick = at[axis] < bricks[axis] ? tissue.brick_at(at * kBrick) : -1;
        if (brick >= 0) {
          column.push_back(brick);
        } else if (!column.empty()) {
          body(column);
          column.clear();
        }
      }
    }
  });
}

// Computes the squared distance to the nearest air voxel along x, for each tissue voxel.
template <class Value>
void pass_along_x(const TissueVoxels& tissue, double spacing, Value* squared) {
  for_each_column(tissue, 0, [&](const std::vector<int>& column) {
    for (int line = 0; line < kBrick * kBrick; ++line) {
      const auto at = [&](int x) {
        return std::int64_t{column[x / kBrick]} * kBrickVoxels + line * kBrick + x % kBrick;
      };
      const auto is_tissue = [&](int x) {
        return tissue.bricks()[column[x / kBrick]].mask[line / kBrick] >> (line % kBrick * kBrick + x % kBrick) & 1;
      };
      const int size = static_cast<int>(column.size()) * kBrick;
      for (int x = 0; x < size; ++x) {
        if (!is_tissue(x)) continue;
        const int begin = x;
        while (x < size && is_tissue(x)) ++x;
        for (int i = begin; i < x; ++i) squared[at(i)] = squared_length<Value>(std::min(i + 1 - begin, x - i), spacing);
      }
    }
  });
}

// Replaces each value by the squared distance that also takes air along y or z into account (lowest_around).
template <class Value>
void pass_across(const TissueVoxels& tissue, int axis, double spacing, Value* squared) {
  const int along = axis == 1 ? kBrick : kBrick * kBrick,
            across = axis == 1 ? kBrick * kBrick : kBrick;  // strides within a brick: along the axis, and across it
  constexpr std::size_t kRowBytes = kBrick * sizeof(Value);
  for_each_column(tissue, axis, [&](const std::vector<int>& column) {
    Lines<Value> lines(column.size(), spacing);
    const int size = static_cast<int>(lines.f.size());
    for (int first = 0; first < kBrick; first += kRows) {
      const auto row = [&](int i, int r) {
        return squared + std::int64_t{column[i / kBrick]} * kBrickVoxels + (first + r) * across + i % kBrick * along;
      };
      for (int i = 0; i < size; ++i)
        for (int r = 0; r < kRows; ++r)
          std::memcpy(reinterpret_cast<char*>(&lines.f[i]) + r * kRowBytes, row(i, r), kRowBytes);
      lines.find_least();
      for (int i = 0; i < size; ++i) {
        const Across<Value> lowest = lowest_around(lines, i);
        for (int r = 0; r < kRows; ++r)
          std::memcpy(row(i, r), reinterpret_cast<const char*>(&lowest) + r * kRowBytes, kRowBytes);
      }
    }
  });
}

// Returns true if no number is above `most`.
bool are_all_within(const ZeroedVector<std::uint16_t>& numbers, int most) {
  std::atomic<bool> within = true;
  parallel_for(std::ssize(numbers), 1 << 18, [&](std::int64_t begin, std::int64_t end) {
    std::uint16_t largest = 0;
    for (auto i = begin; i < end; ++i) largest = std::max(largest, numbers[i]);
    if (largest > most) within = false;
  });
  return within;
}

}  // namespace

TissueDepth::TissueDepth(const TissueVoxels& tissue, const glm::dvec3& spacing, int most_steps) : tissue_(&tissue) {
  if (spacing.x == spacing.y && spacing.y == spacing.z) {
    squared_step_ = spacing.x * spacing.x;
    measure(steps_, glm::dvec3(1));
    if (are_all_within(steps_, most_steps)) return;
    steps_ = {};
  }
  measure(squared_, spacing);
}

template <class Value>
void TissueDepth::measure(ZeroedVector<Value>& squared, const glm::dvec3& spacing) const {
  squared.resize(tissue_->bricks().size() * kBrickVoxels);
  want_large_pages(squared.data(), std::ssize(squared) * std::int64_t{sizeof(Value)});
  pass_along_x(*tissue_, spacing.x, squared.data());
  pass_across(*tissue_, 1, spacing.y, squared.data());
  pass_across(*tissue_, 2, spacing.z, squared.data());
}

double TissueDepth::operator()(const glm::dvec3& rest) const {
  glm::ivec3 v(rest);
  v -= glm::ivec3(glm::lessThan(rest, glm::dvec3(v)));  // rounds down; std::floor would be a function call
  std::array<float, 8> corner{};
  const glm::ivec3 in = v & 7;
  const auto is_inside = [](const glm::ivec3& low, const glm::ivec3& end) {
    return glm::all(glm::greaterThanEqual(low, glm::ivec3(0))) && glm::all(glm::lessThan(low, end));
  };
  // True if the eight voxels around the point are in one brick.
  if (is_inside(in, glm::ivec3(7)) && is_inside(v, tissue_->grid_size())) {
    const int brick = tissue_->brick_at(v);
    if (brick < 0) return 0;
    const std::int64_t first = std::int64_t{brick} * kBrickVoxels + in.x + 8 * in.y + 64 * in.z;
    const std::int64_t place[] = {first,      first + 1,  first + 8,  first + 9,
                                  first + 64, first + 65, first + 72, first + 73};
    for (int k = 0; k < 8; ++k) corner[k] = at(place[k]);
  } else {
    for (int k = 0; k < 8; ++k) corner[k] = at_voxel(v + glm::ivec3(k & 1, k >> 1 & 1, k >> 2));
  }
  const glm::dvec3 high = rest - glm::dvec3(v), low = 1.0 - high;
  double depth = 0;
  for (int k = 0; k < 8; ++k)
    depth += (k & 1 ? high.x : low.x) * (k & 2 ? high.y : low.y) * (k & 4 ? high.z : low.z) * corner[k];
  return depth;
}

}  // namespace limber
