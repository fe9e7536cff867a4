// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/depth.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "core/base/parallel.h"
#include "core/platform/memory_pages.h"
#include "core/volume/float_lanes.h"

namespace limber {

namespace {

constexpr int kBrick = TissueVoxels::kBrick;

using Eight = FloatLanes<kBrick / 4>;  // one voxel of each of eight neighbouring lines

// Eight lines of voxels that bricks of tissue make up. Air, with the value zero, bounds them at both ends.
struct Lines {
  std::vector<Eight> f;      // the values at each position
  std::vector<Eight> least;  // the least values of each brick
  std::vector<float> rise;   // squared length of a number of steps, mm^2

  Lines(std::size_t bricks, double spacing) : f(bricks * kBrick), least(bricks), rise(bricks * kBrick + 1) {
    for (std::size_t steps = 0; steps < rise.size(); ++steps)
      rise[steps] = static_cast<float>(spacing * spacing * double(steps * steps));
  }

  void find_least() {
    for (std::size_t brick = 0; brick < least.size(); ++brick) {
      least[brick] = f[brick * kBrick];
      for (int i = 1; i < kBrick; ++i) lower(least[brick], f[brick * kBrick + i], 0);
    }
  }
};

// Returns the minimum over j of f[j] + rise[|i - j|], for eight lines at once. Bricks whose least values cannot lower
// it any more are passed over.
Eight lowest_around(const Lines& lines, int i) {
  const int own = i / kBrick, bricks = static_cast<int>(lines.least.size());
  const float* rise = lines.rise.data();
  Eight lowest = lines.f[i];
  lower(lowest, Eight{}, rise[i + 1]);
  lower(lowest, Eight{}, rise[bricks * kBrick - i]);
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

}  // namespace

TissueDepth::TissueDepth(const TissueVoxels& tissue, const glm::dvec3& spacing) : tissue_(&tissue) {
  const std::size_t count = tissue.bricks().size() * kBrickVoxels;
  squared_.resize(count);
  want_large_pages(squared_.data(), static_cast<std::int64_t>(count * sizeof(float)));
  pass_along_x(spacing.x);
  pass_across(1, spacing.y);
  pass_across(2, spacing.z);
  if (spacing.x == spacing.y && spacing.y == spacing.z) store_as_steps(spacing.x * spacing.x);
}

// Replaces squared depths by whole multiples of `squared_step`, if they all are, bit for bit, and fit into 16 bits.
void TissueDepth::store_as_steps(double squared_step) {
  constexpr std::int64_t kGrain = 64 * kBrickVoxels;
  const std::int64_t count = std::ssize(squared_);
  steps_.resize(count);
  want_large_pages(steps_.data(), count * std::int64_t{sizeof(std::uint16_t)});
  squared_step_ = squared_step;
  std::atomic<bool> fits = true;
  parallel_for(count, kGrain, [&](std::int64_t begin, std::int64_t end) {
    const double steps_per_mm2 = 1 / squared_step;
    bool same = true;
    for (auto i = begin; i < end; ++i) {
      const int steps = static_cast<int>(squared_[i] * steps_per_mm2 + 0.5);
      steps_[i] = static_cast<std::uint16_t>(steps);
      same &= static_cast<float>(squared_step * steps_[i]) == squared_[i];
    }
    if (!same) fits = false;
  });
  if (fits) squared_ = {};
  else steps_ = {};
}

template <class Body>
void TissueDepth::for_each_column(int axis, const Body& body) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const glm::ivec3 bricks = tissue_->brick_grid();
  parallel_for(std::int64_t{bricks[u]} * bricks[v], 4, [&](std::int64_t begin, std::int64_t end) {
    std::vector<int> column;
    for (auto c = begin; c < end; ++c) {
      glm::ivec3 at(0);
      at[u] = static_cast<int>(c % bricks[u]);
      at[v] = static_cast<int>(c / bricks[u]);
      for (; at[axis] <= bricks[axis]; ++at[axis]) {
        const int brick = at[axis] < bricks[axis] ? tissue_->brick_at(at * kBrick) : -1;
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
void TissueDepth::pass_along_x(double spacing) {
  const double squared_spacing = spacing * spacing;
  for_each_column(0, [&](const std::vector<int>& column) {
    for (int line = 0; line < kBrick * kBrick; ++line) {
      const auto at = [&](int x) {
        return std::int64_t{column[x / kBrick]} * kBrickVoxels + line * kBrick + x % kBrick;
      };
      const auto is_tissue = [&](int x) {
        return tissue_->bricks()[column[x / kBrick]].mask[line / kBrick] >> (line % kBrick * kBrick + x % kBrick) & 1;
      };
      const int size = static_cast<int>(column.size()) * kBrick;
      for (int x = 0; x < size; ++x) {
        if (!is_tissue(x)) continue;
        const int begin = x;
        while (x < size && is_tissue(x)) ++x;
        for (int i = begin; i < x; ++i) {
          const double steps = std::min(i + 1 - begin, x - i);
          squared_[at(i)] = static_cast<float>(squared_spacing * steps * steps);
        }
      }
    }
  });
}

void TissueDepth::pass_across(int axis, double spacing) {
  const int along = axis == 1 ? kBrick : kBrick * kBrick,
            across = axis == 1 ? kBrick * kBrick : kBrick;  // strides within a brick
  for_each_column(axis, [&](const std::vector<int>& column) {
    Lines lines(column.size(), spacing);
    for (int slice = 0; slice < kBrick; ++slice) {
      const auto at = [&](int i) {
        return &squared_[std::int64_t{column[i / kBrick]} * kBrickVoxels + slice * across + i % kBrick * along];
      };
      const int size = static_cast<int>(lines.f.size());
      for (int i = 0; i < size; ++i) std::memcpy(&lines.f[i], at(i), sizeof(Eight));
      lines.find_least();
      for (int i = 0; i < size; ++i) {
        const Eight lowest = lowest_around(lines, i);
        std::memcpy(at(i), &lowest, sizeof(Eight));
      }
    }
  });
}

double TissueDepth::operator()(const glm::dvec3& rest) const {
  glm::ivec3 v(rest);
  v -= glm::ivec3(glm::lessThan(rest, glm::dvec3(v)));  // rounds down; std::floor would be a function call
  std::array<float, 8> corner{};
  const glm::ivec3 in = v & 7;
  const auto is_inside = [](const glm::ivec3& low, const glm::ivec3& end) {
    return glm::all(glm::greaterThanEqual(low, glm::ivec3(0))) && glm::all(glm::lessThan(low, end));
  };
  // True if the eight voxels around the point lie in one brick.
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
