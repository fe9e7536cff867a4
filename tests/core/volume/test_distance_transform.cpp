// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/distance_transform.h"

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/base/parallel.h"

using namespace limber;

namespace {
std::vector<std::uint8_t> random_seeds(const VoxelBox& box, double share, unsigned key) {
  std::mt19937 random(key);
  std::vector<std::uint8_t> seed(box.voxel_count());
  for (auto& s : seed) s = random() < share * 4294967296.0;
  return seed;
}

double nearest_by_trying_all(const VoxelBox& box, const std::vector<std::uint8_t>& seed, const glm::dvec3& spacing,
                             const glm::ivec3& from) {
  double best = INFINITY;
  for (int z = 0; z < box.size.z; ++z)
    for (int y = 0; y < box.size.y; ++y)
      for (int x = 0; x < box.size.x; ++x)
        if (seed[x + box.size.x * (y + box.size.y * z)]) {
          const glm::dvec3 d = glm::dvec3(x - from.x, y - from.y, z - from.z) * spacing;
          best = std::min(best, glm::dot(d, d));
        }
  return best;
}
}  // namespace

TEST_CASE("distance: equals trying every seed, at any spacing and any density of seeds") {
  const VoxelBox box{{3, 4, 5}, {13, 21, 17}};
  for (const glm::dvec3 spacing : {glm::dvec3(1), glm::dvec3(0.277, 0.5, 3), glm::dvec3(20, 3, 0.5)})
    for (const double share : {0.0005, 0.01, 0.3, 0.99}) {
      const auto seed = random_seeds(box, share, 7);
      const auto squared = squared_distance(box, seed, spacing);
      double worst = 0;
      for (int z = 0; z < box.size.z; ++z)
        for (int y = 0; y < box.size.y; ++y)
          for (int x = 0; x < box.size.x; ++x) {
            const double truth = nearest_by_trying_all(box, seed, spacing, {x, y, z});
            worst =
                std::max(worst, std::abs(squared[box.index(box.lowest + glm::ivec3(x, y, z))] - truth) / (1 + truth));
          }
      CHECK(worst < 1e-6);
    }
}

TEST_CASE("distance: equals trying every seed on long lines too, whose seeds lie far apart") {
  for (const VoxelBox& box : {VoxelBox{{0, 0, 0}, {18, 150, 2}}, VoxelBox{{0, 0, 0}, {3, 2, 150}}})
    for (const double step : {0.5, 2.0})
      for (const int last : {60, 145}) {
        std::vector<std::uint8_t> seed(box.voxel_count());
        const bool along_y = box.size.y > box.size.z;
        seed[box.index(along_y ? glm::ivec3(1, 4, 0) : glm::ivec3(1, 0, 4))] = 1;
        seed[box.index(along_y ? glm::ivec3(2, last, 1) : glm::ivec3(2, 1, last))] = 1;
        const auto squared = squared_distance(box, seed, glm::dvec3(2, step, step));
        double worst = 0;
        for (int z = 0; z < box.size.z; z += 3)
          for (int y = 0; y < box.size.y; y += 3)
            for (int x = 0; x < box.size.x; ++x) {
              const double truth = nearest_by_trying_all(box, seed, glm::dvec3(2, step, step), {x, y, z});
              worst = std::max(worst, std::abs(squared[box.index({x, y, z})] - truth) / (1 + truth));
            }
        CHECK(worst < 1e-6);
      }
}

TEST_CASE("distance: is infinite without a seed, and one seed is enough") {
  const VoxelBox box{{0, 0, 0}, {4, 5, 6}};
  std::vector<std::uint8_t> seed(box.voxel_count());
  for (float d : squared_distance(box, seed, glm::dvec3(2))) CHECK(d == INFINITY);
  seed[box.index({1, 2, 3})] = 1;
  const auto squared = squared_distance(box, seed, glm::dvec3(2));
  CHECK(squared[box.index({3, 4, 5})] == 4 * 12);
  CHECK(squared_distance({}, {}, glm::dvec3(1)).empty());
}

TEST_CASE("distance: is signed by side, and neighbours across the border differ by their spacing") {
  const VoxelBox box{{0, 0, 0}, {24, 24, 24}};
  std::vector<std::uint8_t> body(box.voxel_count());
  for (int z = 0; z < 24; ++z)
    for (int y = 0; y < 24; ++y)
      for (int x = 8; x < 16; ++x) body[box.index({x, y, z})] = 1;
  const auto distance = signed_distance(box, body, glm::dvec3(1.5));
  CHECK(distance[box.index({7, 5, 5})] == 1.5f);
  CHECK(distance[box.index({8, 5, 5})] == -1.5f);
  CHECK(distance[box.index({11, 5, 5})] == -6.0f);
  CHECK(distance[box.index({0, 5, 5})] == 12.0f);
}

TEST_CASE("distance: is the same for any number of threads") {
  const VoxelBox box{{0, 0, 0}, {40, 33, 52}};
  const auto seed = random_seeds(box, 0.002, 11);
  std::vector<std::vector<float>> results;
  for (int threads : {1, 2, 4}) {
    ThreadCount count(threads);
    results.push_back(squared_distance(box, seed, {0.7, 1.1, 2.3}));
  }
  CHECK(results[0] == results[1]);
  CHECK(results[0] == results[2]);
}

TEST_CASE("distance: the box around tissue is tight, grows by its margin and stays inside the grid") {
  LabelVolume volume{{.size = {10, 11, 12}}, ZeroedVector<Label>(10 * 11 * 12)};
  CHECK(tissue_box(volume).voxel_count() == 0);
  volume.at({2, 3, 4}) = 5;
  volume.at({7, 9, 4}) = 1;
  CHECK(tissue_box(volume).lowest == glm::ivec3(2, 3, 4));
  CHECK(tissue_box(volume).size == glm::ivec3(6, 7, 1));
  CHECK(tissue_box(volume, 3).lowest == glm::ivec3(0, 0, 1));
  CHECK(tissue_box(volume, 3).size == glm::ivec3(10, 11, 7));
}
