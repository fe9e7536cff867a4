// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/voxel_pieces.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace limber {

namespace {
std::int64_t root_of(std::vector<std::int64_t>& parent, std::int64_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}
}  // namespace

std::vector<std::vector<std::int64_t>> pieces_of(const Grid& grid, const std::vector<std::int64_t>& voxels,
                                                 const glm::ivec3& reach) {
  std::vector<std::int64_t> parent(voxels.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto join = [&](std::int64_t a, std::int64_t b) {
    a = root_of(parent, a), b = root_of(parent, b);
    parent[std::max(a, b)] = std::min(a, b);
  };
  // Unites each voxel with the earlier voxels of the list that are within reach, one row of the grid after the other:
  // the voxels of a row are adjacent in the list.
  std::vector<std::array<int, 2>> rows;  // offsets of the neighbouring rows in y and z
  for (int z = -reach.z; z <= 0; ++z)
    for (int y = -reach.y; y <= (z < 0 ? reach.y : 0); ++y) rows.push_back({y, z});
  std::vector<std::size_t> next(rows.size(), 0);
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const glm::ivec3 v = voxel_of_index(grid, voxels[i]);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const int y = v.y + rows[r][0], z = v.z + rows[r][1];
      if (y < 0 || z < 0 || y >= grid.size.y) continue;
      const std::int64_t first = grid.index({std::max(v.x - reach.x, 0), y, z}),
                         last = grid.index({std::min(v.x + reach.x, grid.size.x - 1), y, z});
      while (next[r] < voxels.size() && voxels[next[r]] < first) ++next[r];
      for (std::size_t k = next[r]; k < i && voxels[k] <= last; ++k) join(i, k);
    }
  }
  std::vector<std::vector<std::int64_t>> pieces;
  std::vector<std::int64_t> place(voxels.size(), -1);
  for (std::int64_t i = 0; i < std::ssize(voxels); ++i) {
    std::int64_t& piece = place[root_of(parent, i)];
    if (piece < 0) piece = std::ssize(pieces), pieces.emplace_back();
    pieces[piece].push_back(i);
  }
  std::stable_sort(pieces.begin(), pieces.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return pieces;
}

glm::ivec3 middle_voxel(const Grid& grid, const std::vector<std::int64_t>& voxels,
                        const std::vector<std::int64_t>& piece) {
  glm::dvec3 middle(0);
  for (const std::int64_t i : piece) middle += glm::dvec3(voxel_of_index(grid, voxels[i]));
  middle /= double(piece.size());
  double least = std::numeric_limits<double>::infinity();
  glm::ivec3 nearest(0);
  for (const std::int64_t i : piece) {
    const glm::ivec3 v = voxel_of_index(grid, voxels[i]);
    const glm::dvec3 d = glm::dvec3(v) - middle;
    if (glm::dot(d, d) < least) least = glm::dot(d, d), nearest = v;
  }
  return nearest;
}

}  // namespace limber
