// SPDX-License-Identifier: AGPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <random>
#include <tuple>

#include <doctest/doctest.h>

#include "core/deform/depth.h"
#include "core/paint/brush_region.h"
#include "core/phantom/phantom.h"

using namespace limber;

namespace {

using Distances = std::map<std::tuple<int, int, int>, float>;

std::tuple<int, int, int> key(const glm::ivec3& v) { return {v.x, v.y, v.z}; }

Distances distances(const TissueVoxels& tissue, const Reached& reached) {
  Distances all;
  int wrong = 0;
  for (const auto& brick : reached.bricks)
    for (int i = brick.begin; i < brick.end; ++i) {
      const int cell = reached.cell[i];
      const glm::ivec3 v = tissue.bricks()[brick.brick].corner + glm::ivec3(cell & 7, cell >> 3 & 7, cell >> 6);
      wrong += tissue.index_of(v) != tissue.bricks()[brick.brick].first + reached.at[i];
      wrong += !all.insert({key(v), reached.distance[i]}).second;
    }
  CHECK(wrong == 0);
  return all;
}

LabelVolume empty_volume(const glm::ivec3& size, const glm::dvec3& spacing = glm::dvec3(1)) {
  LabelVolume volume;
  volume.grid.size = size;
  volume.grid.spacing = spacing;
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  return volume;
}

// Makes tissue with round holes in it.
LabelVolume cheese(std::mt19937& random, const glm::ivec3& size, const glm::dvec3& spacing, int holes) {
  LabelVolume volume = empty_volume(size, spacing);
  for (auto& label : volume.voxels) label = static_cast<Label>(1 + random() % 3);
  for (int h = 0; h < holes; ++h) {
    const glm::dvec3 centre(random() % size.x, random() % size.y, random() % size.z);
    const double radius = 1 + random() % 4;
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
          if (glm::length(glm::dvec3(x, y, z) - centre) <= radius) volume.at({x, y, z}) = 0;
  }
  return volume;
}

glm::dvec3 somewhere(std::mt19937& random, const Grid& grid) {
  const auto share = [&] { return static_cast<double>(random() % 10001) / 10000; };
  return world_from_voxel(grid) * (glm::dvec3(share(), share(), share()) * glm::dvec3(grid.size - 1));
}

template <class Body>
void for_each_voxel(const Grid& grid, const Body& body) {
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) body(glm::ivec3(x, y, z));
}

// Returns the shortest distances from the voxel `start` over steps to the 26 neighbours, mm, up to `radius`. A diagonal
// step counts only if single steps through faces of tissue lead to the same voxel.
//   from  distance that is counted for the start itself, mm
Distances shortest_ways(const LabelVolume& volume, const glm::ivec3& start, double from, double radius) {
  const auto passable = [&](const glm::ivec3& v, const glm::ivec3& step) {
    std::array<int, 3> axes{0, 1, 2};
    do {
      glm::ivec3 at = v;
      bool free = true;
      for (const int axis : axes) {
        at[axis] += step[axis];
        free = free && volume.at_or_air(at) != 0;
      }
      if (free) return true;
    } while (std::next_permutation(axes.begin(), axes.end()));
    return false;
  };
  Distances done;
  using Entry = std::pair<double, std::tuple<int, int, int>>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  queue.push({from, key(start)});
  while (!queue.empty()) {
    const auto [distance, place] = queue.top();
    queue.pop();
    if (distance > radius || !done.insert({place, static_cast<float>(distance)}).second) continue;
    const glm::ivec3 v(std::get<0>(place), std::get<1>(place), std::get<2>(place));
    for (int n = 0; n < 27; ++n) {
      const glm::ivec3 step(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
      if (n == 13 || !passable(v, step)) continue;
      queue.push({distance + glm::length(glm::dvec3(step) * volume.grid.spacing), key(v + step)});
    }
  }
  return done;
}

// Returns true if the straight line between two voxels' centres stays in tissue, with a small margin at voxel edges.
bool is_in_sight(const LabelVolume& volume, const glm::ivec3& from, const glm::ivec3& to) {
  const glm::dvec3 way(to - from);
  const int samples = 24 * (1 + std::max({std::abs(to.x - from.x), std::abs(to.y - from.y), std::abs(to.z - from.z)}));
  for (int i = 0; i <= samples; ++i) {
    const glm::dvec3 at = glm::dvec3(from) + way * (double(i) / samples);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 off = (glm::dvec3(corner & 1, corner >> 1 & 1, corner >> 2) - 0.5) * 0.02;
      if (volume.at_or_air(glm::ivec3(glm::floor(at + off + 0.5))) == 0) return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("brush reach: the Euclidean ball is what looking at every voxel finds, whatever the spacing") {
  std::mt19937 random(1);
  for (int round = 0; round < 30; ++round) {
    const glm::dvec3 spacing = round % 2 ? glm::dvec3(1) : glm::dvec3(0.7, 1.3, 2.1);
    LabelVolume volume = cheese(random, {30, 26, 21}, spacing, 12);
    if (round % 3 == 0) volume.grid.direction = glm::dmat3(0, 1, 0, -1, 0, 0, 0, 0, -1);
    const TissueVoxels tissue(volume);
    BrushReach reach(volume, tissue);
    const glm::dvec3 centre = somewhere(random, volume.grid);
    const double radius = 0.5 + random() % 1000 / 70.0;
    const Distances found = distances(tissue, reach.dab(centre, radius, BrushDistance::Euclidean));
    std::size_t expected = 0;
    const AffineTransform world = world_from_voxel(volume.grid);
    for_each_voxel(volume.grid, [&](const glm::ivec3& v) {
      const double distance = glm::length(world * glm::dvec3(v) - centre);
      if (volume.at(v) == 0 || distance > radius) return;
      ++expected;
      const auto at = found.find(key(v));
      REQUIRE(at != found.end());
      CHECK(at->second == doctest::Approx(distance).epsilon(1e-4));
    });
    CHECK(found.size() == expected);
  }
}

TEST_CASE(
    "brush reach: ways inside tissue are straight where the centre is in sight, else as long as from voxel to voxel") {
  std::mt19937 random(2);
  std::int64_t in_sight = 0, exact = 0, behind = 0, bent = 0, too_short = 0, missed = 0, not_joined = 0;
  double detour = 0, shortest = 1;
  for (int round = 0; round < 24; ++round) {
    const glm::dvec3 spacing = round % 2 ? glm::dvec3(1) : glm::dvec3(0.8, 1, 1.5);
    const LabelVolume volume = cheese(random, {30, 26, 22}, spacing, 30);
    const TissueVoxels tissue(volume);
    BrushReach reach(volume, tissue);
    const glm::ivec3 start(random() % 30, random() % 26, random() % 22);
    if (volume.at(start) == 0) continue;
    const double radius = 4 + random() % 8;
    const Distances found = distances(
        tissue, reach.dab(world_from_voxel(volume.grid) * glm::dvec3(start), radius, BrushDistance::Geodesic));
    // Paths of steps in 26 directions are up to 13 % longer than the straight line.
    const Distances ways = shortest_ways(volume, start, 0, 1.3 * radius);
    for (const auto& [place, way] : ways) missed += way <= 0.95 * radius && !found.count(place);
    for (const auto& [place, distance] : found) {
      const glm::ivec3 v(std::get<0>(place), std::get<1>(place), std::get<2>(place));
      const double straight = glm::length(glm::dvec3(v - start) * spacing);
      too_short += distance < straight * (1 - 1e-5);
      if (is_in_sight(volume, start, v)) {
        ++in_sight;
        exact += distance <= straight * (1 + 1e-5) + 1e-6;
        bent += distance > straight * 1.01 + 1e-6;
        continue;
      }
      ++behind;
      const auto way = ways.find(place);
      not_joined += way == ways.end();
      if (way == ways.end()) continue;
      detour = std::max(detour, (double(distance) - way->second) / std::max({spacing.x, spacing.y, spacing.z}));
      shortest = std::min(shortest, double(distance) / way->second);
    }
  }
  MESSAGE(in_sight, " voxels in sight, ", behind, " not; of the way from voxel to voxel at least ", shortest,
          ", at most ", detour, " voxels more");
  CHECK(in_sight > 5000);
  CHECK(behind > 1000);
  CHECK(bent == 0);
  CHECK(exact > in_sight * 0.999);
  CHECK(too_short == 0);
  CHECK(missed == 0);
  CHECK(not_joined == 0);
  CHECK(detour < 0.75);
  CHECK(shortest > 0.8);
}

TEST_CASE(
    "brush reach: from a finger nothing is touched on the finger beside it, and around a short gap only the far way") {
  // Two fingers of 6 x 6 voxels, one voxel of air apart, that are joined at a palm.
  LabelVolume volume = empty_volume({40, 12, 80});
  for (int z = 4; z < 76; ++z)
    for (int y = 3; y < 9; ++y)
      for (int x = 6; x < 19; ++x)
        if (x != 12 || z >= 66) volume.at({x, y, z}) = 1;
  const TissueVoxels tissue(volume);
  BrushReach reach(volume, tissue);
  for (const double radius : {6.0, 16.0, 40.0}) {
    const Distances ball = distances(tissue, reach.dab({11, 6, 20}, radius, BrushDistance::Euclidean));
    const Distances ways = distances(tissue, reach.dab({11, 6, 20}, radius, BrushDistance::Geodesic));
    const auto across = [](const Distances& all) {
      return std::count_if(all.begin(), all.end(), [](const auto& at) { return std::get<0>(at.first) > 12; });
    };
    CHECK(across(ball) > 0);
    CHECK(across(ways) == 0);
    CHECK(ways.size() + static_cast<std::size_t>(across(ball)) == ball.size());
  }
  // Near the palm, the path between the fingers leads along the gap (x = 12) to its end at z = 66, and back.
  const Distances round = distances(tissue, reach.dab({11, 6, 60}, 16, BrushDistance::Geodesic));
  const auto other = round.find({13, 6, 60});
  REQUIRE(other != round.end());
  CHECK(other->second == doctest::Approx(2 * (5 + std::sqrt(2))).epsilon(1e-5));
  CHECK(round.count({13, 6, 50}) == 0);
}

TEST_CASE("brush reach: no way crosses a seam, and one leads round its end") {
  LabelVolume volume = empty_volume({40, 12, 80});
  for (int z = 4; z < 76; ++z)
    for (int y = 3; y < 9; ++y)
      for (int x = 6; x < 19; ++x) volume.at({x, y, z}) = 1;
  TissueVoxels tissue(volume);
  auto seams = std::make_shared<Seams>(volume.grid.size);
  for (int z = 4; z < 66; ++z)
    for (int y = 3; y < 9; ++y) seams->cut({11, y, z}, 0);
  const Distances before = distances(tissue, BrushReach(volume, tissue).dab({11, 6, 20}, 16, BrushDistance::Geodesic));
  tissue.set_seams(seams);
  BrushReach reach(volume, tissue);
  const Distances ways = distances(tissue, reach.dab({11, 6, 20}, 16, BrushDistance::Geodesic));
  int own = 0;
  for (const auto& [place, distance] : before) own += std::get<0>(place) <= 11;
  CHECK(std::ssize(ways) == own);
  for (const auto& [place, distance] : ways) {
    CHECK(std::get<0>(place) <= 11);
    CHECK(distance == doctest::Approx(before.at(place)));
  }

  const Distances round = distances(tissue, reach.dab({11, 6, 60}, 16, BrushDistance::Geodesic));
  const auto other = round.find({12, 6, 60});
  REQUIRE(other != round.end());
  CHECK(other->second >= 12);
  CHECK(other->second <= 13);
  for (const auto& [place, distance] : round)
    if (std::get<0>(place) > 11 && std::get<2>(place) < 66) CHECK(distance >= 6 + 65.5f - std::get<2>(place));
  CHECK(round.count({12, 6, 54}) == 0);
}

TEST_CASE("brush reach: fingers that touch by an edge of voxels are apart") {
  LabelVolume volume = empty_volume({24, 24, 24});
  for (int z = 2; z < 22; ++z)
    for (int y = 2; y < 22; ++y)
      for (int x = 2; x < 22; ++x)
        if ((x < 12) == (y < 12)) volume.at({x, y, z}) = 1;
  const TissueVoxels tissue(volume);
  BrushReach reach(volume, tissue);
  for (const auto& [place, distance] : distances(tissue, reach.dab({11, 11, 11}, 15, BrushDistance::Geodesic)))
    CHECK(std::get<0>(place) < 12);
}

TEST_CASE(
    "brush reach: between fingers, and between arm and trunk, only what tissue joins within the radius is touched" *
    doctest::test_suite("slow")) {
  for (const bool whole : {false, true}) {
    const Phantom body = whole ? make_body_phantom(8) : make_arm_phantom(3);
    const TissueVoxels tissue(body.volume);
    BrushReach reach(body.volume, tissue);
    const AffineTransform world = world_from_voxel(body.volume.grid);
    std::mt19937 random(3);
    std::vector<glm::ivec3> beside_gap;
    tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
      for (int axis = 0; axis < 2; ++axis) {
        glm::ivec3 step(0);
        step[axis] = 1;
        const auto label = [&](int steps) { return body.volume.at_or_air(v + steps * step); };
        if (label(1) == 0 && (label(2) || label(3) || label(4))) beside_gap.push_back(v);
      }
    });
    REQUIRE(beside_gap.size() > 20);
    int gaps = 0, beyond = 0;
    for (int round = 0; round < 100; ++round) {
      const glm::ivec3 start = beside_gap[random() % beside_gap.size()];
      const double radius = body.volume.grid.spacing.x * (4 + random() % 10);
      const glm::dvec3 centre = world * glm::dvec3(start);
      // A geodesic path of length `radius` may touch voxels whose centres lie up to a voxel further away than `radius`.
      const double beyond_radius = radius + body.volume.grid.spacing.x;
      const Distances ball = distances(tissue, reach.dab(centre, beyond_radius, BrushDistance::Euclidean));
      const Distances ways = distances(tissue, reach.dab(centre, radius, BrushDistance::Geodesic));
      Distances joined;  // voxels that are reached through faces inside the ball
      std::vector<glm::ivec3> front{start};
      joined[key(start)] = 0;
      while (!front.empty()) {
        const glm::ivec3 v = front.back();
        front.pop_back();
        for (int direction = 0; direction < 6; ++direction) {
          glm::ivec3 next = v;
          next[direction >> 1] += direction & 1 ? 1 : -1;
          if (ball.count(key(next)) && joined.insert({key(next), 0.0f}).second) front.push_back(next);
        }
      }
      gaps += joined.size() < ball.size();
      for (const auto& [place, distance] : ways) beyond += joined.count(place) == 0;
    }
    MESSAGE("of 100 balls ", gaps, " held tissue beyond a gap");
    CHECK(gaps > 10);
    CHECK(beyond == 0);
  }
}

TEST_CASE("brush reach: only what the filter allows, and ways through the rest all the same") {
  std::mt19937 random(4);
  const glm::dvec3 spacing(1, 1.5, 0.8);
  const LabelVolume volume = cheese(random, {40, 32, 40}, spacing, 25);
  const TissueVoxels tissue(volume);
  const TissueDepth depth(tissue, spacing);
  BrushReach everything(volume, tissue);
  BrushFilter filter;
  const AffineTransform world = world_from_voxel(volume.grid);

  const auto check = [&](const char* what, const auto& allowed) {
    BrushReach some(volume, tissue, filter);
    std::size_t touched = 0, left_out = 0;
    for (int round = 0; round < 6; ++round) {
      const glm::dvec3 centre = somewhere(random, volume.grid);
      for (const auto kind : {BrushDistance::Euclidean, BrushDistance::Geodesic}) {
        const Distances all = distances(tissue, everything.dab(centre, 9, kind)),
                        found = distances(tissue, some.dab(centre, 9, kind));
        std::size_t expected = 0;
        for (const auto& [place, distance] : all) {
          const glm::ivec3 v(std::get<0>(place), std::get<1>(place), std::get<2>(place));
          if (!allowed(v)) continue;
          ++expected;
          REQUIRE_MESSAGE(found.count(place), what);
          CHECK(found.at(place) == distance);
        }
        CHECK_MESSAGE(found.size() == expected, what);
        touched += expected;
        left_out += all.size() - expected;
      }
    }
    CHECK_MESSAGE(touched > 0, what);
    CHECK_MESSAGE(left_out > 0, what);
  };

  filter.labels.assign(65536, 0);
  filter.labels[2] = 1;
  check("labels", [&](const glm::ivec3& v) { return volume.at(v) == 2; });
  filter = {};
  filter.box = {{10, 5, 12}, {30, 25, 28.5}};
  check("box",
        [&](const glm::ivec3& v) { return v.x >= 10 && v.x <= 30 && v.y >= 5 && v.y <= 25 && v.z >= 12 && v.z <= 28; });
  filter = {};
  filter.plane = {{20, 20, 15}, glm::normalize(glm::dvec3(1, 2, -1))};
  check("plane", [&](const glm::ivec3& v) {
    return glm::dot(world * glm::dvec3(v) - filter.plane->point, filter.plane->normal) <= 0;
  });
  filter = {};
  filter.allows = [&](std::int64_t place, const glm::ivec3& v) {
    return tissue.index_of(v) == place && place % 3 == 1;
  };
  check("predicate", [&](const glm::ivec3& v) { return tissue.index_of(v) % 3 == 1; });

  const auto at_surface = [&](const glm::ivec3& v) {
    for (int direction = 0; direction < 6; ++direction) {
      glm::ivec3 next = v;
      next[direction >> 1] += direction & 1 ? 1 : -1;
      if (volume.at_or_air(next) == 0) return true;
    }
    return false;
  };
  filter = {};
  filter.depth = BrushDepth::Surface;
  check("surface", at_surface);
  filter.depth = BrushDepth::ToDepth;
  for (const double depth_mm : {0.5, 2.0, 3.3}) {
    filter.depth_mm = depth_mm;
    check("depth", [&](const glm::ivec3& v) { return at_surface(v) || depth.at_voxel(v) <= depth_mm * (1 + 1e-6); });
  }
}

TEST_CASE("brush reach: beside the tissue a dab starts from what is nearest, and far from it nothing is touched") {
  LabelVolume volume = empty_volume({20, 20, 20});
  for (int z = 5; z < 15; ++z)
    for (int y = 5; y < 15; ++y)
      for (int x = 5; x < 15; ++x) volume.at({x, y, z}) = 1;
  const TissueVoxels tissue(volume);
  BrushReach reach(volume, tissue);
  const Distances found = distances(tissue, reach.dab({3.6, 10, 10}, 3, BrushDistance::Geodesic));
  REQUIRE(found.count({5, 10, 10}));
  CHECK(found.at({5, 10, 10}) == doctest::Approx(1.4));
  CHECK(reach.dab({1, 10, 10}, 3, BrushDistance::Geodesic).size() == 0);
  CHECK(reach.dab({-1e12, 10, 10}, 3, BrushDistance::Geodesic).size() == 0);
  CHECK(reach.dab({-1e12, 10, 10}, 3, BrushDistance::Euclidean).size() == 0);
  CHECK(reach.dab({10, 10, 10}, 1e4, BrushDistance::Geodesic).size() == 1000);
  CHECK(reach.dab({10, 10, 10}, 0, BrushDistance::Euclidean).size() == 0);
}

TEST_CASE("brush reach: memory follows the ball and does not grow from dab to dab" * doctest::test_suite("slow")) {
  std::mt19937 random(5);
  const LabelVolume volume = cheese(random, {96, 96, 96}, glm::dvec3(1), 300);
  const TissueVoxels tissue(volume);
  BrushReach reach(volume, tissue);
  std::int64_t first = 0;
  for (int round = 0; round < 3; ++round) {
    std::mt19937 same(6);
    for (int i = 0; i < 40; ++i) reach.dab(somewhere(same, volume.grid), 8, BrushDistance::Geodesic);
    if (round == 0) first = reach.memory_bytes();
    CHECK(reach.memory_bytes() == first);
  }
  CHECK(first < 300'000);
}
