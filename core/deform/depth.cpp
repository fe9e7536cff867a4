// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/depth.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/parallel.h"

namespace limber {

namespace {

constexpr int kBrick = TissueVoxels::kBrick;

// Eight neighbouring lines, voxel by voxel.
using Eight = std::array<float, kBrick>;

// The least of f[j] + (i - j)^2 squared_spacing over j, for eight lines at once. Air, of height zero, must bound them.
Eight lowest_around(const Eight* f, double squared_spacing) {
  Eight lowest = *f;
  for (std::ptrdiff_t steps = 1;; ++steps) {
    const float rise = static_cast<float>(squared_spacing * double(steps * steps));
    int further = 0;
    for (int l = 0; l < kBrick; ++l) further |= lowest[l] > rise;
    if (!further) return lowest;
    const Eight &before = f[-steps], &after = f[steps];
    for (int l = 0; l < kBrick; ++l) {
      const float nearer = std::min(before[l], after[l]) + rise;
      lowest[l] = std::min(lowest[l], nearer);
    }
  }
}

}  // namespace

TissueDepth::TissueDepth(const TissueVoxels& tissue, const glm::dvec3& spacing)
    : tissue_(&tissue), depth_(tissue.bricks().size() * kBrickVoxels) {
  pass_along_x(spacing.x);
  pass_across(1, spacing.y);
  pass_across(2, spacing.z);
  for (float& d : depth_) d = std::sqrt(d);
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

// Squared distances along each line.
void TissueDepth::pass_along_x(double spacing) {
  const double squared_spacing = spacing * spacing;
  for_each_column(0, [&](const std::vector<int>& column) {
    for (int line = 0; line < kBrick * kBrick; ++line) {
      const auto at = [&](int x) { return std::int64_t{column[x / kBrick]} * kBrickVoxels + line * kBrick + x % kBrick; };
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
          depth_[at(i)] = static_cast<float>(squared_spacing * steps * steps);
        }
      }
    }
  });
}

void TissueDepth::pass_across(int axis, double spacing) {
  const int along = axis == 1 ? kBrick : kBrick * kBrick, across = axis == 1 ? kBrick * kBrick : kBrick;  // strides in a brick
  for_each_column(axis, [&](const std::vector<int>& column) {
    std::vector<Eight> lines(column.size() * kBrick + 2);  // air at both ends
    for (int slice = 0; slice < kBrick; ++slice) {
      Eight* line = &lines[1];
      for (const int brick : column)
        for (int i = 0; i < kBrick; ++i)
          std::copy_n(&depth_[std::int64_t{brick} * kBrickVoxels + slice * across + i * along], kBrick, (line++)->begin());
      line = &lines[1];
      for (const int brick : column)
        for (int i = 0; i < kBrick; ++i, ++line) {
          const Eight lowest = lowest_around(line, spacing * spacing);
          std::copy_n(lowest.begin(), kBrick, &depth_[std::int64_t{brick} * kBrickVoxels + slice * across + i * along]);
        }
    }
  });
}

double TissueDepth::operator()(const glm::dvec3& rest) const {
  const glm::dvec3 low = glm::floor(rest), f = rest - low;
  const glm::ivec3 v(low);
  double depth = 0;
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 corner(k & 1, k >> 1 & 1, k >> 2);
    const double share = (corner.x ? f.x : 1 - f.x) * (corner.y ? f.y : 1 - f.y) * (corner.z ? f.z : 1 - f.z);
    if (share > 0) depth += share * at_voxel(v + corner);
  }
  return depth;
}

}  // namespace limber
