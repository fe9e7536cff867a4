// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/surface_points.h"

#include <numeric>
#include <random>

#include <doctest/doctest.h>

namespace limber {

namespace {

Occupancy empty_cells(const glm::ivec3& size) {
  Occupancy cells{{size, {1, 1, 1}, {0, 0, 0}, glm::dmat3(1)}, {}};
  cells.share.assign(cells.grid.voxel_count(), 0);
  return cells;
}

// Returns the cells that steps across faces reach from `seed`: all filled or all empty, like the seed.
std::vector<std::int64_t> piece_at(const Occupancy& cells, const glm::ivec3& seed) {
  std::vector<std::uint8_t> seen(cells.share.size(), 0);
  std::vector<glm::ivec3> front{seed};
  std::vector<std::int64_t> piece;
  const bool filled = cells.filled(seed);
  seen[cells.grid.index(seed)] = 1;
  while (!front.empty()) {
    const glm::ivec3 at = front.back();
    front.pop_back();
    piece.push_back(cells.grid.index(at));
    for (int k = 0; k < 6; ++k) {
      glm::ivec3 next = at;
      next[k / 2] += k % 2 ? 1 : -1;
      if (!cells.grid.contains(next) || cells.filled(next) != filled || seen[cells.grid.index(next)]++) continue;
      front.push_back(next);
    }
  }
  return piece;
}

}  // namespace

TEST_CASE("surface points: closing a body fills what no way from outside leads to and drops specks, and nothing else") {
  std::mt19937 random(5);
  for (double density : {0.2, 0.5, 0.7}) {
    Occupancy cells = empty_cells({9, 8, 7});
    for (float& share : cells.share) share = random() % 1000 < 1000 * density ? 1 : 0;
    Occupancy closed = cells;
    close_body(closed);
    std::int64_t largest = 0;
    const auto each = [&](const auto& visit) {
      for (int z = 0; z < 7; ++z)
        for (int y = 0; y < 8; ++y)
          for (int x = 0; x < 9; ++x) visit(glm::ivec3(x, y, z));
    };
    each([&](const glm::ivec3& at) {
      if (cells.filled(at)) largest = std::max(largest, std::ssize(piece_at(cells, at)));
    });
    int wrong = 0;
    each([&](const glm::ivec3& at) {
      const auto piece = piece_at(cells, at);
      bool open = false;
      for (std::int64_t i : piece) {
        const std::int64_t x = i % 9, y = i / 9 % 8, z = i / 72;
        open = open || x == 0 || y == 0 || z == 0 || x == 8 || y == 7 || z == 6;
      }
      const bool expected = cells.filled(at) ? 50 * std::ssize(piece) >= largest : !open;
      wrong += closed.filled(at) != expected;
    });
    CHECK(wrong == 0);
  }
}

TEST_CASE("surface points: coarser cells hold the same tissue in the same place") {
  Occupancy fine = empty_cells({7, 5, 6});
  fine.grid.spacing = {1, 2, 1};
  fine.grid.origin = {3, 4, 5};
  std::mt19937 random(6);
  for (float& share : fine.share) share = float(random() % 5) / 4;
  const Occupancy coarse = coarsened(fine, 2);
  CHECK(coarse.grid.size == glm::ivec3(4, 5, 3));
  const auto held = [](const Occupancy& cells) {
    glm::dvec4 sum(0);
    const AffineTransform to_world = world_from_voxel(cells.grid);
    const double volume = cells.grid.spacing.x * cells.grid.spacing.y * cells.grid.spacing.z;
    for (std::int64_t i = 0; i < std::ssize(cells.share); ++i) {
      const glm::ivec3 size = cells.grid.size;
      const glm::dvec3 place = to_world * glm::dvec3(i % size.x, i / size.x % size.y, i / (size.x * size.y));
      sum += volume * cells.share[i] * glm::dvec4(place, 1);
    }
    return sum;
  };
  CHECK(held(coarse).w == doctest::Approx(held(fine).w));
  CHECK(glm::distance(glm::dvec3(held(coarse)) / held(coarse).w, glm::dvec3(held(fine)) / held(fine).w) < 0.5);
}

}  // namespace limber
