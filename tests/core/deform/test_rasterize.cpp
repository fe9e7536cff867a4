// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/rasterize.h"

#include <map>
#include <random>
#include <tuple>

#include <doctest/doctest.h>

using namespace limber;

namespace {

constexpr VoxelRange kEverywhere{glm::ivec3(-1000), glm::ivec3(1000)};

// Rasterizes N^3 cubes with edges of three output voxels, whose inner corners are moved by random multiples of `step`.
// Coarse steps put many voxel centres exactly on faces, edges and corners.
template <class Claim>
void rasterize_jittered(int n, int step, unsigned seed, const Claim& claim) {
  std::mt19937 random(seed);
  std::map<std::tuple<int, int, int>, FixedPoint> moved;
  auto corner = [&](const glm::ivec3& c) {
    auto [place, is_new] = moved.try_emplace({c.x, c.y, c.z}, c * (3 * kFixedOne) - kFixedOne / 2);
    if (is_new)
      for (int axis = 0; axis < 3; ++axis)
        if (c[axis] > 0 && c[axis] < n) place->second[axis] += (int(random() % 3) - 1) * step;
    return place->second;
  };
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        std::array<FixedPoint, 8> corners;
        for (int i = 0; i < 8; ++i) corners[i] = corner(glm::ivec3(x, y, z) + glm::ivec3(i & 1, i >> 1 & 1, i >> 2));
        PosedCell(corners.data(), 2, 4, {x, y, z}).rasterize(kEverywhere, claim);
      }
}

}  // namespace

TEST_CASE("rasterize: every voxel inside a jittered lattice is claimed exactly once, ties included, and none outside") {
  constexpr int kCubes = 6, kVoxels = 3 * kCubes;
  for (int step : {0, kFixedOne / 4, kFixedOne / 8, 12345, 1})
    for (unsigned seed = 0; seed < 8; ++seed) {
      std::vector<int> claims(kVoxels * kVoxels * kVoxels, 0);
      int outside = 0, inverted = 0;
      rasterize_jittered(kCubes, step, seed, [&](const CellClaim& claim) {
        const glm::ivec3 v = claim.voxel;
        inverted += claim.posed_per_rest <= 0;
        if (glm::any(glm::lessThan(v, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(v, glm::ivec3(kVoxels))))
          ++outside;
        else ++claims[v.x + kVoxels * (v.y + kVoxels * v.z)];
      });
      CHECK(outside == 0);
      CHECK(inverted == 0);
      CHECK(std::count(claims.begin(), claims.end(), 1) == std::ssize(claims));
    }
}

TEST_CASE(
    "rasterize: a tet with a face all but parallel to the rows of voxels has the voxels inside it, and no others") {
  for (int k = 0; k < 40; ++k) {
    const int s = 8 * kFixedOne + 12345 * k;
    const std::array<FixedPoint, 4> tet{FixedPoint(0), FixedPoint(s, -1, -1), FixedPoint(0, s, s - 1),
                                        FixedPoint(s / 2, 0, s)};
    const VoxelRange box = voxels_in_box(tet);
    std::vector<glm::ivec3> expected, visited;
    const TetFaces<__int128> faces(tet);
    for (int z = box.low.z; z <= box.high.z; ++z)
      for (int y = box.low.y; y <= box.high.y; ++y)
        for (int x = box.low.x; x <= box.high.x; ++x)
          if (faces.contains({x, y, z})) expected.push_back({x, y, z});
    rasterize_tet(tet, kEverywhere, [&](const glm::ivec3& v, int) {
      if (visited.size() <= expected.size()) visited.push_back(v);
    });
    CHECK(expected.size() > 20);
    CHECK(visited == expected);
  }
}

TEST_CASE("rasterize: a turned cube gives back the rest points of its voxels, as many as its volume holds") {
  const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(0.8, glm::normalize(glm::dvec3(1, 2, 3))));
  std::array<FixedPoint, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 offset(i & 1 ? 10 : -10, i & 2 ? 10 : -10, i & 4 ? 10 : -10);
    corners[i] = FixedPoint(glm::round((turn * offset + glm::dvec3(0.3, 40.1, -7)) * double(kFixedOne)));
  }
  int count = 0;
  double largest = 0;
  PosedCell(corners.data(), 2, 4, {4, 5, 6}).rasterize(kEverywhere, [&](const CellClaim& claim) {
    const glm::dvec3 expected =
        glm::transpose(turn) * (glm::dvec3(claim.voxel) - glm::dvec3(0.3, 40.1, -7)) / 20.0 + glm::dvec3(4, 5, 6);
    largest = std::max(largest, glm::distance(claim.rest, expected));
    ++count;
  });
  CHECK(largest < 1e-5);
  CHECK(std::abs(count - 8000) < 120);
}

TEST_CASE("rasterize: a large tet and its halves cover the same voxels, each once") {
  const FixedPoint a(0, 0, 0), b(40 * kFixedOne, 3, 7), c(11, 40 * kFixedOne, 5), d(2, 9, 40 * kFixedOne),
      middle = (b + c) / 2;
  auto cover = [](const std::vector<std::array<FixedPoint, 4>>& tets) {
    std::map<std::tuple<int, int, int>, int> claims;
    for (const auto& tet : tets)
      rasterize_tet(tet, voxels_in_box(tet), [&](const glm::ivec3& v, int) { ++claims[{v.x, v.y, v.z}]; });
    return claims;
  };
  // `middle` is rounded, so the outer faces of the halves differ from those of the whole tet by less than a unit, and
  // voxels at these faces may differ. Therefore the test compares only the numbers of voxels.
  const auto halves = cover({{a, b, middle, d}, {a, middle, c, d}});
  int twice = 0;
  for (const auto& [voxel, count] : halves) twice += count != 1;
  CHECK(twice == 0);
  CHECK(std::abs(double(halves.size()) - double(cover({{a, b, c, d}}).size())) < 1000);
  CHECK(halves.size() > 9000);
}
