// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/voxel_pieces.h"

#include <algorithm>
#include <random>
#include <set>

#include <doctest/doctest.h>

using namespace limber;

namespace {
std::multiset<std::set<std::int64_t>> pieces_by_flooding(const Grid& grid, const std::vector<std::int64_t>& voxels,
                                                         const glm::ivec3& reach) {
  std::set<std::int64_t> left(voxels.begin(), voxels.end());
  std::multiset<std::set<std::int64_t>> pieces;
  while (!left.empty()) {
    std::set<std::int64_t> piece;
    std::vector<std::int64_t> open{*left.begin()};
    left.erase(left.begin());
    while (!open.empty()) {
      const std::int64_t at = open.back();
      open.pop_back();
      piece.insert(at);
      const glm::ivec3 v(at % grid.size.x, at / grid.size.x % grid.size.y, at / grid.size.x / grid.size.y);
      const glm::ivec3 wide = 2 * reach + 1;
      for (int k = 0; k < wide.x * wide.y * wide.z; ++k) {
        const glm::ivec3 n = v + glm::ivec3(k % wide.x, k / wide.x % wide.y, k / wide.x / wide.y) - reach;
        if (grid.contains(n) && left.erase(grid.index(n))) open.push_back(grid.index(n));
      }
    }
    pieces.insert(std::move(piece));
  }
  return pieces;
}
}  // namespace

TEST_CASE("voxel pieces: they are what flooding from voxel to voxel finds, the largest first") {
  std::mt19937 random(11);
  for (const glm::ivec3 size : {glm::ivec3(9, 7, 8), glm::ivec3(1, 20, 3), glm::ivec3(30, 1, 1), glm::ivec3(5, 5, 1)})
    for (const double share : {0.02, 0.08, 0.3}) {
      const glm::ivec3 reach = share < 0.05 ? glm::ivec3(3, 2, 1) : share < 0.1 ? glm::ivec3(1, 2, 2) : glm::ivec3(1);
      const Grid grid{.size = size};
      std::vector<std::int64_t> voxels;
      for (std::int64_t at = 0; at < grid.voxel_count(); ++at)
        if (std::uniform_real_distribution<double>(0, 1)(random) < share) voxels.push_back(at);
      const auto pieces = pieces_of(grid, voxels, reach);
      std::multiset<std::set<std::int64_t>> found;
      for (std::size_t k = 0; k < pieces.size(); ++k) {
        CHECK((k == 0 || pieces[k - 1].size() >= pieces[k].size()));
        std::set<std::int64_t> piece;
        for (const std::int64_t i : pieces[k]) piece.insert(voxels[i]);
        found.insert(piece);
      }
      CHECK(found == pieces_by_flooding(grid, voxels, reach));
    }
}

TEST_CASE("voxel pieces: the middle voxel of a ring belongs to the ring") {
  const Grid grid{.size = {9, 9, 1}};
  std::vector<std::int64_t> ring;
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 9; ++x)
      if (std::max(std::abs(x - 4), std::abs(y - 4)) == 3) ring.push_back(grid.index({x, y, 0}));
  const auto pieces = pieces_of(grid, ring);
  REQUIRE(pieces.size() == 1);
  const glm::ivec3 middle = middle_voxel(grid, ring, pieces[0]);
  CHECK(std::find(ring.begin(), ring.end(), grid.index(middle)) != ring.end());
}
