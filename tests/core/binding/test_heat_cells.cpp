// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/binding/heat_cells.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <set>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/binding/cell_paths.h"
#include "core/binding/heat_diffusion.h"
#include "tests/core/skin/small_body.h"

using namespace limber;
using namespace limber::test;

namespace {
// Two fingers on a palm. `finger_of` says of each voxel above the palm to which finger it belongs (0 or 1), or -1: air.
// Each finger has a bone in its middle, and the palm has one.
struct Hand {
  SmallBody body;
  TissueVoxels tissue;
  BoneParts parts;
  std::function<int(const glm::ivec3&)> finger_of;
};

constexpr int kWidth = 44, kDepth = 24, kHeight = 64, kPalm = 16;

Hand two_fingers(const std::function<int(const glm::ivec3&)>& finger_of,
                 const std::function<bool(const glm::ivec3&)>& is_cut_below_x = {}) {
  Hand hand;
  hand.finger_of = finger_of;
  LabelVolume& volume = hand.body.volume;
  volume.grid.size = {kWidth, kDepth, kHeight};
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  auto is_in = [](const glm::ivec3& v, const glm::ivec3& low, const glm::ivec3& high) {
    return glm::all(glm::greaterThanEqual(v, low)) && glm::all(glm::lessThan(v, high));
  };
  for (int z = 2; z < kHeight - 2; ++z)
    for (int y = 4; y < kDepth - 4; ++y)
      for (int x = 3; x < kWidth - 3; ++x) {
        const glm::ivec3 v(x, y, z);
        if (z >= kPalm && finger_of(v) < 0) continue;
        const bool is_bone = is_in(v, {8, 10, 4}, {kWidth - 8, 14, 10}) || is_in(v, {8, 10, 20}, {12, 14, 58}) ||
                             is_in(v, {kWidth - 12, 10, 20}, {kWidth - 8, 14, 58});
        volume.at(v) = is_bone ? kBone : kMuscle;
      }
  hand.body.tissues = muscle_and_bone();
  hand.body.armature.bones = {bone_between("Palm", -1, {22, 12, 3}, {22, 12, 11}),
                              bone_between("First", 0, {10, 12, 18}, {10, 12, 59}),
                              bone_between("Second", 0, {kWidth - 10, 12, 18}, {kWidth - 10, 12, 59})};
  hand.tissue = TissueVoxels(volume);
  if (is_cut_below_x) {
    auto seams = std::make_shared<Seams>(volume.grid.size);
    for (int z = 0; z < kHeight; ++z)
      for (int y = 0; y < kDepth; ++y)
        for (int x = 1; x < kWidth; ++x)
          if (is_cut_below_x({x, y, z}) && hand.tissue.holds({x, y, z}) && hand.tissue.holds({x - 1, y, z}))
            seams->cut({x - 1, y, z}, 0);
    hand.tissue.set_seams(seams);
  }
  hand.parts = split_bones(volume, hand.tissue, hand.body.tissues, hand.body.armature);
  return hand;
}

// Returns settings whose cells are blocks of (2^shift)^3 voxels.
HeatDiffusion in_cells(const TissueVoxels& tissue, int shift) {
  HeatDiffusion settings;
  settings.most_cells = std::max<std::int64_t>(1, (tissue.size() >> (3 * shift)) + 1);
  return settings;
}

SkinWeights weights_of(const Hand& hand, const HeatDiffusion& settings) {
  return diffuse_heat(hand.body.volume, hand.tissue, hand.body.tissues, hand.body.armature, hand.parts, settings);
}

// Returns, for each voxel, the largest difference between its weights for a bone in `a` and in `b`, sorted ascending.
std::vector<double> differences(const SkinWeights& a, const SkinWeights& b) {
  std::vector<double> all;
  for (std::int64_t c = 0; c < a.chunk_count(); ++c)
    for (size_t i = 0; i < a.chunk(c).size(); ++i) {
      double largest = 0;
      for (int bone = 0; bone < std::ssize(a.bones()); ++bone)
        largest = std::max(largest, std::abs(a.chunk(c)[i].of(bone) - b.chunk(c)[i].of(bone)));
      all.push_back(largest);
    }
  std::sort(all.begin(), all.end());
  return all;
}
double quantile(const std::vector<double>& ascending, double share) {
  return ascending[static_cast<std::size_t>(share * static_cast<double>(ascending.size() - 1))];
}

// Returns the largest weight that the flesh of one finger gives to the bone of the other, above height z.
double largest_leak(const Hand& hand, const SkinWeights& weights, int z) {
  double largest = 0;
  for (std::int64_t b = 0; b < std::ssize(hand.tissue.bricks()); ++b)
    hand.tissue.for_each(b, b + 1, [&](std::int64_t place, const glm::ivec3& v) {
      if (v.z < z) return;
      const Influence& influence = weights.chunk(b)[place - hand.tissue.bricks()[b].first];
      largest = std::max(largest, influence.of(hand.finger_of(v) == 0 ? 2 : 1));
    });
  return largest;
}

// Two fingers whose gap of one voxel lies at x, or at x and further along x with height (a staircase of voxels that
// touch by their edges only).
auto gap_at(int x, int slope = 1 << 20) {
  return [=](const glm::ivec3& v) {
    const int gap = x + (v.z - kPalm) / slope;
    return v.x < gap ? 0 : v.x > gap ? 1 : -1;
  };
}

HeatCells cells_of(const Hand& hand, const ZeroedVector<std::uint16_t>& held_by, const HeatLaw& law, int shift) {
  return make_heat_cells({hand.body.volume, hand.tissue, held_by, law.conductivity}, law,
                         glm::i16vec3(static_cast<std::int16_t>(shift)));
}
}  // namespace

TEST_CASE("heat cells: a limb has the same weights whether heat is solved for in voxels or in cells") {
  const SmallBody body = two_bone_bar(32, 96, 12, glm::dvec3(1));
  const TissueVoxels tissue(body.volume);
  const SkinWeights voxels = diffuse_heat(body.volume, body.tissues, body.armature);
  for (const int shift : {1, 2}) {
    CAPTURE(shift);
    WeightsReport report;
    const SkinWeights cells =
        diffuse_heat(body.volume, body.tissues, body.armature, in_cells(tissue, shift), no_progress(), &report);
    CHECK(report.residual <= 1e-5);
    CHECK(report.warnings.empty());
    const std::vector<double> by = differences(voxels, cells);
    CHECK(by.back() > 0);
    CHECK(by.back() < (shift == 1 ? 0.1 : 0.2));
    CHECK(quantile(by, 0.99) < (shift == 1 ? 0.02 : 0.05));
    CHECK(quantile(by, 0.5) < (shift == 1 ? 2e-3 : 5e-3));
  }
}

TEST_CASE("heat cells: no weight crosses a gap of one voxel between fingers, wherever the blocks of cells lie") {
  std::vector<std::function<int(const glm::ivec3&)>> gaps{gap_at(14, 3), gap_at(20, 9)};
  for (const int x : {19, 20, 21, 22, 23}) gaps.push_back(gap_at(x));
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    CAPTURE(k);
    const Hand hand = two_fingers(gaps[k]);
    const SkinWeights voxels = weights_of(hand, {});
    CHECK(largest_leak(hand, voxels, 40) < 1e-3);
    for (const int shift : {1, 2}) {
      CAPTURE(shift);
      const SkinWeights cells = weights_of(hand, in_cells(hand.tissue, shift));
      CHECK(largest_leak(hand, cells, 40) < 1e-3);
      const std::vector<double> by = differences(voxels, cells);
      CHECK(quantile(by, 0.99) < (shift == 1 ? 0.06 : 0.1));
    }
  }
}

TEST_CASE("heat cells: no weight crosses a seam between fingers that touch, also inside a block of cells") {
  for (const int x : {20, 21, 22, 23}) {
    CAPTURE(x);
    const auto is_cut = [x](const glm::ivec3& v) { return v.x == x && v.z >= kPalm; };
    const Hand hand = two_fingers([x](const glm::ivec3& v) { return v.x < x ? 0 : 1; }, is_cut);
    const SkinWeights open = [&] {
      Hand joined = hand;
      joined.tissue.set_seams(nullptr);
      return weights_of(joined, in_cells(hand.tissue, 1));
    }();
    CHECK(largest_leak(hand, open, 40) > 0.3);
    for (const int shift : {0, 1, 2}) {
      CAPTURE(shift);
      CHECK(largest_leak(hand, weights_of(hand, in_cells(hand.tissue, shift)), 40) < 1e-3);
    }
  }
}

TEST_CASE("heat cells: a sheet of one voxel beside another sheet keeps its own weights") {
  // From x = 18 on, the fingers are sheets of one voxel, one voxel apart, that run side by side across the hand: all
  // their blocks hold parts of both. Each sheet is joined to the flesh of its own finger only.
  const auto finger_of = [](const glm::ivec3& v) {
    if (v.x < 18) return v.z < 40 ? 0 : -1;
    if (v.x >= 30) return 1;
    if (v.y == 9 && v.z < 40) return v.x < 29 ? 0 : -1;
    return v.y == 11 ? (v.x > 18 ? 1 : -1) : -1;
  };
  const Hand hand = two_fingers(finger_of);
  const SkinWeights voxels = weights_of(hand, {});
  for (const int shift : {1, 2}) {
    CAPTURE(shift);
    const SkinWeights cells = weights_of(hand, in_cells(hand.tissue, shift));
    CHECK(largest_leak(hand, voxels, 32) < 0.01);
    CHECK(largest_leak(hand, cells, 32) < 0.01);
  }
}

TEST_CASE("heat cells: 1, 2 and 4 threads give the same weights") {
  const Hand hand = two_fingers(gap_at(21, 7));
  std::vector<SkinWeights> results;
  for (const int threads : {1, 2, 4}) {
    const ThreadCount limit(threads);
    results.push_back(weights_of(hand, in_cells(hand.tissue, 1)));
  }
  CHECK(results[0] == results[1]);
  CHECK(results[0] == results[2]);
}

TEST_CASE("heat cells: an island in the air is named, and its voxels follow one bone") {
  const Hand hand = two_fingers([](const glm::ivec3& v) {
    if (v.x >= 18 && v.x < 22 && v.y > 8 && v.y < 12 && v.z > 30 && v.z < 40) return 0;
    return v.x < 16 ? 0 : v.x > 24 ? 1 : -1;
  });
  WeightsReport report;
  const SkinWeights weights = diffuse_heat(hand.body.volume, hand.tissue, hand.body.tissues, hand.body.armature,
                                           hand.parts, in_cells(hand.tissue, 1), no_progress(), &report);
  REQUIRE(report.warnings.size() == 1);
  CHECK(report.warnings[0].find("108 voxels of label 1") != std::string::npos);
  const int brick = hand.tissue.brick_at({20, 10, 35});
  CHECK(weights.chunk(brick)[hand.tissue.index_of({20, 10, 35}) - hand.tissue.bricks()[brick].first].weight[0] ==
        kFullWeight);
}

TEST_CASE("heat cells: a cell is a connected set of soft voxels of one block, and links are the same both ways") {
  const auto is_cut = [](const glm::ivec3& v) { return v.x == 29 && v.z >= kPalm; };
  const Hand hand = two_fingers(gap_at(21, 5), is_cut);
  const ZeroedVector<std::uint16_t> held_by = fixed_bone(hand.body.volume, hand.tissue, hand.parts, hand.body.armature);
  const HeatLaw law(hand.body.volume.grid, hand.body.tissues);
  for (const int shift : {1, 2, 3}) {
    CAPTURE(shift);
    const HeatCells cells = cells_of(hand, held_by, law, shift);
    // A flood through the soft voxels of a block must reach exactly the voxels of the cell in which it starts.
    auto cell_at = [&](const glm::ivec3& v) {
      const std::int64_t place = hand.body.volume.grid.contains(v) ? hand.tissue.index_of(v) : -1;
      if (place < 0 || held_by[place] != kSoft) return -1;
      return int{cells.cell(hand.tissue.brick_at(v), cells.number_in_brick[place])};
    };
    std::vector<std::int64_t> voxels(cells.graph.size(), 0);
    std::vector<glm::dvec3> sum(cells.graph.size(), glm::dvec3(0));
    std::set<int> seen;
    hand.tissue.for_each([&](std::int64_t, const glm::ivec3& seed) {
      const int cell = cell_at(seed);
      if (cell < 0) return;
      ++voxels[cell];
      sum[cell] += glm::dvec3(seed);
      if (!seen.insert(cell).second) return;
      std::vector<glm::ivec3> open{seed};
      std::set<std::int64_t> reached{hand.tissue.index_of(seed)};
      for (std::size_t k = 0; k < open.size(); ++k)
        for (int direction = 0; direction < 6; ++direction) {
          glm::ivec3 w = open[k];
          w[direction >> 1] += direction & 1 ? 1 : -1;
          if ((w >> shift) != (seed >> shift) || cell_at(w) < 0) continue;
          if (hand.tissue.seams()->is_cut_towards(open[k], direction)) continue;
          if (reached.insert(hand.tissue.index_of(w)).second) open.push_back(w);
        }
      for (const glm::ivec3& v : open) CHECK(cell_at(v) == cell);
      voxels[cell] -= std::ssize(open);
    });
    CHECK(std::ssize(seen) == cells.graph.size());
    CHECK(std::all_of(voxels.begin(), voxels.end(), [](std::int64_t left) { return left == 0; }));
    for (std::int32_t c = 0; c < cells.graph.size(); ++c)
      for (std::int32_t k = cells.graph.first[c]; k < cells.graph.first[c + 1]; ++k) {
        const std::int32_t d = cells.graph.neighbour[k];
        CHECK((c < cells.graph.red_count) != (d < cells.graph.red_count));
        const auto begin = cells.graph.neighbour.begin() + cells.graph.first[d],
                   end = cells.graph.neighbour.begin() + cells.graph.first[d + 1];
        const auto back = std::find(begin, end, c);
        REQUIRE(back != end);
        CHECK(cells.graph.conductance[back - cells.graph.neighbour.begin()] ==
              doctest::Approx(cells.graph.conductance[k]).epsilon(1e-5));
      }
  }
}

TEST_CASE("heat cells: paths to voxels are as long as those from voxel to voxel") {
  const Hand hand = two_fingers(gap_at(21, 5));
  const Grid& grid = hand.body.volume.grid;
  const Armature& rig = hand.body.armature;
  const ZeroedVector<std::uint16_t> held_by = fixed_bone(hand.body.volume, hand.tissue, hand.parts, rig);
  const NearestBone exact = attracting_bone(hand.body.volume, hand.tissue, rig, held_by);
  const HeatLaw law(grid, hand.body.tissues);
  const std::vector<BoneReach> reaches = reaches_of_bones(rig);
  for (const int shift : {1, 2}) {
    CAPTURE(shift);
    const HeatCells cells = cells_of(hand, held_by, law, shift);
    const std::vector<CellPath> paths = paths_to_cells(grid, hand.tissue, cells, reaches);
    const PathsToVoxels to_voxels(grid, cells, paths, rig, reaches);
    std::vector<double> error;
    std::int64_t others = 0;
    std::vector<CellPath> listed;
    for (std::int64_t b = 0; b < std::ssize(hand.tissue.bricks()); ++b)
      hand.tissue.for_each(b, b + 1, [&](std::int64_t place, const glm::ivec3& v) {
        if (held_by[place] != kSoft) return;
        to_voxels.list(cells.cell(b, cells.number_in_brick[place]), listed);
        REQUIRE(!listed.empty());
        const auto found = to_voxels.nearest(listed, v);
        error.push_back(std::abs(found.distance - exact.distance[place]));
        others += found.bone != exact.bone[place];
      });
    std::sort(error.begin(), error.end());
    CHECK(quantile(error, 0.99) < (shift == 1 ? 1.2 : 1.8));
    CHECK(quantile(error, 0.5) < 0.2);
    CHECK(static_cast<double>(others) < 0.02 * static_cast<double>(error.size()));
  }
}

TEST_CASE("heat cells: cells are as coarse as needed, and as cubic as possible") {
  Grid grid;
  grid.spacing = glm::dvec3(1);
  CHECK(shift_of_cells(grid, 1000, 1000) == glm::i16vec3(0));
  CHECK(shift_of_cells(grid, 1001, 1000) == glm::i16vec3(1));
  CHECK(shift_of_cells(grid, 9000, 1000) == glm::i16vec3(2));
  CHECK(shift_of_cells(grid, 1'000'000'000, 1000) == glm::i16vec3(3));
  grid.spacing = {0.5, 0.5, 1};
  CHECK(shift_of_cells(grid, 4000, 1000) == glm::i16vec3(1, 1, 0));
  CHECK(shift_of_cells(grid, 8000, 1000) == glm::i16vec3(2, 2, 1));
  grid.spacing = {0.5, 0.5, 8};
  CHECK(shift_of_cells(grid, 1'000'000, 1000) == glm::i16vec3(3, 3, 0));
}
