// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/prepare/prepare.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include <doctest/doctest.h>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/volume/connected_components.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {
LabelVolume empty_volume(const glm::ivec3& size, const glm::dvec3& spacing = glm::dvec3(1)) {
  LabelVolume volume{{size, spacing, glm::dvec3(10, -20, 30), glm::dmat3(1)}, {}};
  volume.voxels.assign(volume.grid.voxel_count(), 0);
  return volume;
}

// An oblique, mirrored grid with random labels.
LabelVolume noise(const glm::ivec3& size, int labels, unsigned seed) {
  LabelVolume volume = empty_volume(size, {0.7, 1.1, 2.0});
  const double c = std::cos(0.3), s = std::sin(0.3);
  volume.grid.direction = glm::dmat3(glm::dvec3(c, s, 0), glm::dvec3(s, -c, 0), glm::dvec3(0, 0, 1));
  std::mt19937 random(seed);
  for (Label& label : volume.voxels) label = static_cast<Label>(random() % labels);
  return volume;
}

// Makes concentric balls: marrow (3) inside cortex (2) inside fat (4) inside skin (1). Skin and cortex are thin.
LabelVolume onion(double spacing, double skin, double cortex) {
  const int n = static_cast<int>(64 / spacing);
  LabelVolume volume = empty_volume(glm::ivec3(n), glm::dvec3(spacing));
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const double r = glm::length((glm::dvec3(x, y, z) + 0.5) * spacing - glm::dvec3(32.3, 31.6, 32.1));
        volume.at({x, y, z}) = r < 12 ? 3 : r < 12 + cortex ? 2 : r < 26 ? 4 : r < 26 + skin ? 1 : 0;
      }
  return volume;
}

// Counts pairs of neighbouring voxels with labels a and b, by faces only or also by edges and corners.
std::int64_t contacts(const LabelVolume& volume, auto is_a, auto is_b, bool corners) {
  const glm::ivec3 size = volume.grid.size;
  std::int64_t count = 0;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        if (!is_a(volume.at({x, y, z}))) continue;
        for (int k = -1; k <= 1; ++k)
          for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i)
              if (corners || std::abs(i) + std::abs(j) + std::abs(k) == 1)
                count += is_b(volume.at_or_air({x + i, y + j, z + k}));
      }
  return count;
}
auto label_is(Label label) {
  return [label](Label other) { return other == label; };
}

std::int64_t count_of(const LabelVolume& volume, Label label) {
  return std::count(volume.voxels.begin(), volume.voxels.end(), label);
}

// Returns the share of each label in a box, integrated over the original voxels.
std::map<Label, double> shares_in_box(const LabelVolume& volume, const glm::dvec3& low, const glm::dvec3& high) {
  std::map<Label, double> shares;
  const glm::ivec3 first = glm::floor(low), last = glm::ceil(high);
  for (int z = first.z; z < last.z; ++z)
    for (int y = first.y; y < last.y; ++y)
      for (int x = first.x; x < last.x; ++x) {
        const glm::dvec3 cover = glm::min(high, glm::dvec3(x, y, z) + 1.0) - glm::max(low, glm::dvec3(x, y, z));
        if (cover.x > 0 && cover.y > 0 && cover.z > 0)
          shares[volume.at_or_air({x, y, z})] += cover.x * cover.y * cover.z;
      }
  return shares;
}

// Returns each voxel's label by its world position, to compare volumes on different grids.
std::map<std::array<long, 3>, Label> labels_by_place(const LabelVolume& volume) {
  std::map<std::array<long, 3>, Label> labels;
  const auto world = world_from_voxel(volume.grid);
  const glm::ivec3 size = volume.grid.size;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x) {
        const glm::dvec3 p = world * glm::dvec3(x, y, z);
        labels[{std::lround(p.x * 1e4), std::lround(p.y * 1e4), std::lround(p.z * 1e4)}] = volume.at({x, y, z});
      }
  return labels;
}
}  // namespace

TEST_CASE("regrid: where nothing thin is at stake each voxel has the label with the largest share of its box") {
  // Two half spaces and a slab, all thicker than a voxel. No layer can tear, so the majority vote alone decides.
  LabelVolume volume = empty_volume({37, 29, 31}, {1, 1, 1});
  for (int z = 0; z < 31; ++z)
    for (int y = 0; y < 29; ++y)
      for (int x = 0; x < 37; ++x) volume.at({x, y, z}) = x + 0.4 * y < 12 ? 0 : x + 0.4 * y + 0.2 * z < 26 ? 7 : 9;
  for (const glm::dvec3& spacing :
       {glm::dvec3(2, 2, 2), glm::dvec3(1.7, 2.3, 3.1), glm::dvec3(0.6, 0.5, 1.0), glm::dvec3(3, 0.8, 1.3)}) {
    CAPTURE(spacing.x);
    const LabelVolume result = regrid(volume, spacing);
    int wrong = 0;
    for (int z = 0; z < result.grid.size.z; ++z)
      for (int y = 0; y < result.grid.size.y; ++y)
        for (int x = 0; x < result.grid.size.x; ++x) {
          const glm::dvec3 low = glm::dvec3(x, y, z) * spacing;
          auto shares = shares_in_box(volume, low, low + spacing);
          const double own = shares[result.at({x, y, z})];
          for (const auto& [label, share] : shares) wrong += share > own + 1e-9;
        }
    CHECK(wrong == 0);
  }
}

TEST_CASE("regrid: the new grid covers the old one, and the same spacing gives the same volume") {
  const LabelVolume volume = noise({11, 7, 5}, 4, 1);
  const LabelVolume same = regrid(volume, volume.grid.spacing);
  CHECK(same.grid == volume.grid);
  CHECK(same.voxels == volume.voxels);

  const glm::dvec3 spacing(1.5, 2.5, 3);
  const LabelVolume result = regrid(volume, spacing);
  const auto corner = [](const Grid& grid, double at) {
    return world_from_voxel(grid) * (at * glm::dvec3(grid.size) - 0.5);
  };
  CHECK(glm::length(corner(result.grid, 0) - corner(volume.grid, 0)) < 1e-9);
  const glm::dvec3 end = voxel_from_world(result.grid) * corner(volume.grid, 1) + 0.5;
  for (int axis = 0; axis < 3; ++axis) CHECK(end[axis] <= result.grid.size[axis] + 1e-9);
}

TEST_CASE("regrid: a voxel cut into whole parts keeps its label in all of them") {
  const LabelVolume volume = noise({5, 6, 7}, 5, 2);
  const LabelVolume result = regrid(volume, volume.grid.spacing / 3.0);
  REQUIRE(result.grid.size == 3 * volume.grid.size);
  bool equal = true;
  for (int z = 0; z < result.grid.size.z; ++z)
    for (int y = 0; y < result.grid.size.y; ++y)
      for (int x = 0; x < result.grid.size.x; ++x) equal &= result.at({x, y, z}) == volume.at(glm::ivec3(x, y, z) / 3);
  CHECK(equal);
}

TEST_CASE("regrid: layers thinner than a voxel stay closed") {
  const auto below_skin = [](Label l) { return l > 1; };
  for (const double skin : {1.2, 2.0})
    for (const double spacing : {2.0, 2.6, 3.0, 4.0, 5.5}) {
      CAPTURE(skin);
      CAPTURE(spacing);
      // Skin of 2 mm separates air from the tissue also at corners, skin of 1.2 mm only at faces. Cortex separates
      // marrow from fat.
      const LabelVolume fine = onion(1, skin, 1.2), coarse = regrid(fine, glm::dvec3(spacing));
      const bool corners = skin == 2;
      REQUIRE(contacts(fine, label_is(0), below_skin, corners) == 0);
      CHECK(contacts(coarse, label_is(0), below_skin, corners) == 0);
      if (spacing <= 4)
        CHECK(contacts(
                  coarse, label_is(3), [](Label l) { return l == 4 || l <= 1; }, false) == 0);
      CHECK(contacts(
                coarse, label_is(1), [](Label l) { return l == 2 || l == 3; }, false) == 0);
      const double before = (std::ssize(fine.voxels) - count_of(fine, 0)) * fine.grid.voxel_volume();
      const double after = (std::ssize(coarse.voxels) - count_of(coarse, 0)) * coarse.grid.voxel_volume();
      CHECK(after == doctest::Approx(before).epsilon(0.04));
    }
}

TEST_CASE("regrid: a voxel that is mostly air stays air, also between layers that are closed") {
  // Skin, fat and muscle in random voxels with gaps of air between them, as in a volume of separate structures.
  LabelVolume volume = empty_volume(glm::ivec3(36), glm::dvec3(1));
  std::mt19937 random(7);
  for (Label& label : volume.voxels) label = random() % 5 < 3 ? Label(0) : static_cast<Label>(1 + random() % 3);
  for (const int ratio : {2, 3}) {
    const LabelVolume coarse = regrid(volume, glm::dvec3(ratio));
    int tissue = 0, grown = 0;
    const glm::ivec3 size = coarse.grid.size;
    for (int z = 0; z < size.z; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
          if (coarse.at({x, y, z}) == 0) continue;
          ++tissue;
          int air = 0;
          for (int n = 0; n < ratio * ratio * ratio; ++n)
            air += volume.at(glm::ivec3(x, y, z) * ratio +
                             glm::ivec3(n % ratio, n / ratio % ratio, n / ratio / ratio)) == 0;
          grown += 2 * air > ratio * ratio * ratio;
        }
    CHECK(tissue > 0);
    CHECK(grown == 0);
  }
}

TEST_CASE("regrid: tissue that lies open in the volume stays open") {
  // Fat (4) under skin (1) is cut through. On the cut, fat touches air, and this stays allowed.
  LabelVolume volume = empty_volume({24, 24, 24});
  for (int z = 4; z < 12; ++z)
    for (int y = 4; y < 20; ++y)
      for (int x = 4; x < 20; ++x) volume.at({x, y, z}) = x == 4 || x == 19 || y == 4 || y == 19 || z == 4 ? 1 : 4;
  const LabelVolume coarse = regrid(volume, glm::dvec3(2));
  CHECK(coarse.at({5, 5, 5}) == 4);
  CHECK(coarse.at({5, 5, 6}) == 0);
  CHECK(coarse.at({5, 5, 2}) == 1);
}

TEST_CASE("regrid does not depend on the number of threads") {
  const LabelVolume volume = onion(1, 1.2, 1.2);
  LabelVolume one;
  {
    const ThreadCount limit(1);
    one = regrid(volume, glm::dvec3(2.7));
  }
  const ThreadCount limit(3);
  CHECK(regrid(volume, glm::dvec3(2.7)).voxels == one.voxels);
}

TEST_CASE("regrid: a spacing that makes no sense is refused") {
  const LabelVolume volume = empty_volume({4, 4, 4});
  CHECK_THROWS_AS(regrid(volume, glm::dvec3(0)), Error);
  CHECK_THROWS_AS(regrid(volume, glm::dvec3(-1)), Error);
  CHECK_THROWS_AS(regrid(volume, glm::dvec3(NAN)), Error);
  CHECK_THROWS_AS(regrid(volume, glm::dvec3(1e-4)), Error);
  CHECK(regrid(volume, glm::dvec3(1e6)).voxels.size() == 1);
}

TEST_CASE("reorient moves no voxel in the world, and back again is the identity") {
  const LabelVolume volume = noise({5, 4, 3}, 4, 3);
  for (const char* code : {"LPS", "RAS", "SLP", "PIR", "ASL"}) {
    CAPTURE(code);
    const LabelVolume turned = reorient(volume, code);
    CHECK(labels_by_place(turned) == labels_by_place(volume));
    CHECK(reorient(turned, code).grid == turned.grid);
  }
  const LabelVolume back = reorient(reorient(volume, "SLP"), "LAS");  // LAS is the orientation of `volume`
  CHECK(back.voxels == volume.voxels);
  CHECK(back.grid.size == volume.grid.size);
  CHECK(glm::length(back.grid.origin - volume.grid.origin) < 1e-9);
  CHECK(reorient(empty_volume({2, 3, 4}), "SRA").grid.size == glm::ivec3(4, 2, 3));
  for (const char* code : {"", "LP", "LPSS", "LRS", "XYZ", "LLL"}) CHECK_THROWS_AS(reorient(volume, code), Error);
}

TEST_CASE("flip mirrors the body across the world axis whatever the voxel order, and twice is the identity") {
  LabelVolume volume = empty_volume({6, 4, 5});
  volume.at({1, 2, 3}) = 9;
  const LabelVolume turned = reorient(volume, "SRA");
  for (int axis = 0; axis < 3; ++axis) {
    glm::ivec3 expected(1, 2, 3);
    expected[axis] = volume.grid.size[axis] - 1 - expected[axis];
    CHECK(flip(volume, axis).at(expected) == 9);
    CHECK(flip(volume, axis).grid == volume.grid);
    CHECK(labels_by_place(flip(turned, axis)) == labels_by_place(flip(volume, axis)));
    CHECK(flip(flip(turned, axis), axis).voxels == turned.voxels);
  }
}

TEST_CASE("crop keeps all tissue where it is, pad puts air around, and both undo each other") {
  LabelVolume volume = empty_volume({20, 18, 16}, {1, 2, 3});
  volume.at({5, 6, 7}) = 1;
  volume.at({9, 8, 7}) = 2;
  const LabelVolume cropped = crop_to_tissue(volume);
  CHECK(cropped.grid.size == glm::ivec3(5, 3, 1));
  CHECK(glm::length(world_from_voxel(cropped.grid) * glm::dvec3(4, 2, 0) -
                    world_from_voxel(volume.grid) * glm::dvec3(9, 8, 7)) < 1e-9);
  CHECK(cropped.at({4, 2, 0}) == 2);
  const LabelVolume padded = pad(cropped, 3);
  CHECK(padded.grid.size == glm::ivec3(11, 9, 7));
  CHECK(padded.at({7, 5, 3}) == 2);
  CHECK(crop_to_tissue(padded).voxels == cropped.voxels);
  CHECK(glm::length(crop_to_tissue(padded).grid.origin - cropped.grid.origin) < 1e-9);
  CHECK_THROWS_AS(crop_to_tissue(empty_volume({3, 3, 3})), Error);
  CHECK_THROWS_AS(pad(cropped, -1), Error);
  CHECK_THROWS_AS(pad(cropped, 2000000000), Error);
}

TEST_CASE("connected components agree with a flood fill over all 26 neighbours") {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const LabelVolume volume = noise({13, 9, 8}, 2 + seed % 5, seed);
    const Components components = connected_components(volume);
    std::vector<int> filled(volume.voxels.size(), -1);
    std::vector<std::int64_t> sizes;
    for (std::int64_t start = 0; start < std::ssize(filled); ++start) {
      if (volume.voxels[start] == 0 || filled[start] >= 0) continue;
      std::vector<std::int64_t> stack{start};
      filled[start] = static_cast<int>(sizes.size());
      sizes.push_back(0);
      while (!stack.empty()) {
        const std::int64_t i = stack.back();
        stack.pop_back();
        ++sizes.back();
        const glm::ivec3 size = volume.grid.size, v(i % size.x, i / size.x % size.y, i / (size.x * size.y));
        for (int n = 0; n < 27; ++n) {
          const glm::ivec3 w = v + glm::ivec3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1);
          if (!volume.grid.contains(w)) continue;
          const std::int64_t k = volume.grid.index(w);
          if (filled[k] < 0 && volume.voxels[k] == volume.voxels[i]) filled[k] = filled[i], stack.push_back(k);
        }
      }
    }
    CHECK(components.voxels == sizes);
  }
}

TEST_CASE("specks take the label around them, pieces that are large enough stay") {
  LabelVolume volume = empty_volume({20, 20, 20});
  for (int z = 2; z < 18; ++z)
    for (int y = 2; y < 18; ++y)
      for (int x = 2; x < 18; ++x) volume.at({x, y, z}) = 1;
  volume.at({5, 5, 5}) = 2;                               // a single voxel
  volume.at({9, 9, 9}) = 3, volume.at({10, 10, 10}) = 3;  // two voxels that touch at a corner
  volume.at({13, 9, 9}) = 4, volume.at({14, 9, 9}) = 4, volume.at({15, 9, 9}) = 4;
  volume.at({0, 0, 0}) = 1;  // a voxel in air
  const LabelVolume result = drop_specks(volume, 3);
  CHECK(result.at({5, 5, 5}) == 1);
  CHECK(count_of(result, 3) == 0);
  CHECK(count_of(result, 4) == 3);
  CHECK(result.at({0, 0, 0}) == 0);
  CHECK(drop_specks(result, 3).voxels == result.voxels);
}

TEST_CASE("merging gives all voxels of one label another") {
  const LabelVolume volume = noise({6, 5, 4}, 4, 5);
  const LabelVolume merged = merge_labels(volume, 2, 3);
  CHECK(count_of(merged, 2) == 0);
  CHECK(count_of(merged, 3) == count_of(volume, 2) + count_of(volume, 3));
  CHECK(count_of(merged, 1) == count_of(volume, 1));
}

TEST_CASE("statistics of a box are those of the box, and the CSV says them") {
  LabelVolume volume = empty_volume({12, 10, 8}, {1, 2, 3});
  for (int z = 2; z < 6; ++z)
    for (int y = 3; y < 8; ++y)
      for (int x = 1; x < 7; ++x) volume.at({x, y, z}) = 5;
  volume.at({10, 9, 7}) = 5;
  const auto statistics = label_statistics(volume);
  REQUIRE(statistics.size() == 1);
  const LabelStatistics& s = statistics[0];
  CHECK(s.voxels == 6 * 5 * 4 + 1);
  CHECK(s.volume_mm3 == doctest::Approx(121 * 6.0));
  CHECK(s.lowest == glm::ivec3(1, 3, 2));
  CHECK(s.highest == glm::ivec3(10, 9, 7));
  CHECK(s.components == 2);
  CHECK(s.surface_voxels == 6 * 5 * 4 - 4 * 3 * 2 + 1);
  const glm::dvec3 centre = (120.0 * glm::dvec3(3.5, 5, 3.5) + glm::dvec3(10, 9, 7)) / 121.0;
  CHECK(glm::length(s.centre - (glm::dvec3(10, -20, 30) + centre * glm::dvec3(1, 2, 3))) < 1e-9);

  TissueTable tissues;
  tissues.tissues.push_back({.label = 5, .file_value = 70000, .name = "a \"good\" one", .density = 2});
  const std::string csv = to_csv(statistics, tissues);
  CHECK(csv.find("70000,\"a \"\"good\"\" one\",121,726,1.452,") != std::string::npos);
}
