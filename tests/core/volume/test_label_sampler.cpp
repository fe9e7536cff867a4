// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/label_sampler.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "core/base/parallel.h"
#include "core/volume_io/volume_io.h"
#include "tests/support/shared_data.h"

using namespace limber;

namespace {
LabelVolume random_volume(const glm::ivec3& size, int labels, unsigned key) {
  LabelVolume volume{{.size = size}, {}};
  std::mt19937 random(key);
  volume.voxels.resize(volume.grid.voxel_count());
  for (auto& label : volume.voxels) label = random() % labels;
  return volume;
}
}  // namespace

TEST_CASE("label sampler: a voxel's centre has that voxel's label, whatever surrounds it") {
  const LabelVolume volume = random_volume({9, 8, 7}, 5, 1);
  const LabelSampler sampler(volume);
  const LabelSet all(65536, 1);
  for (int z = -1; z <= 7; ++z)
    for (int y = -1; y <= 8; ++y)
      for (int x = -1; x <= 9; ++x) {
        const Label label = volume.at_or_air({x, y, z});
        CHECK(sampler.nearest(glm::dvec3(x, y, z)) == label);
        CHECK(sampler.tissue(glm::dvec3(x, y, z)) == label);
        if (label) CHECK(sampler.tissue(glm::dvec3(x, y, z), all) == label);
      }
}

TEST_CASE("label sampler: answers tissue exactly where the nearest voxel is tissue") {
  const LabelVolume volume = random_volume({9, 8, 7}, 3, 2);
  const LabelSampler sampler(volume);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-3, 12);
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 p(place(random), place(random), place(random));
    CHECK((sampler.tissue(p) != 0) == (sampler.nearest(p) != 0));
  }
}

TEST_CASE("label sampler: answers only what is allowed") {
  const LabelVolume volume = random_volume({9, 8, 7}, 5, 4);
  const LabelSampler sampler(volume);
  LabelSet allowed(65536, 0);
  allowed[2] = allowed[3] = 1;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0, 6);
  for (int i = 0; i < 20000; ++i) {
    const Label label = sampler.tissue({place(random), place(random), place(random)}, allowed);
    CHECK((label == 0 || label == 2 || label == 3));
  }
  CHECK(sampler.tissue({3.2, 3.7, 3.4}, LabelSet(65536, 0)) == 0);
}

TEST_CASE("label sampler: the allowed tissue nearest to a point is the one found by trying every voxel") {
  LabelVolume volume = random_volume({12, 11, 10}, 40, 6);
  for (auto& label : volume.voxels)
    if (label > 2) label = 0;
  const LabelSampler sampler(volume);
  LabelSet allowed(65536, 0);
  allowed[1] = 1;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 9);
  for (int i = 0; i < 300; ++i) {
    const glm::dvec3 p(place(random), place(random), place(random));
    double best = std::numeric_limits<double>::infinity();
    for (int z = 0; z < 10; ++z)
      for (int y = 0; y < 11; ++y)
        for (int x = 0; x < 12; ++x)
          if (volume.at({x, y, z}) == 1) best = std::min(best, glm::length(glm::dvec3(x, y, z) - p));
    const Label found = sampler.nearest_of(p, allowed, 12);
    CHECK(found == 1);
    CHECK((sampler.nearest_of(p, allowed, static_cast<int>(best / std::sqrt(3.0) - 0.5) - 1) == 0));
    CHECK(sampler.nearest_of(p, allowed, static_cast<int>(best + 0.5)) == 1);
  }
}

TEST_CASE("label sampler: inside a bone the tissue that prevails around it is answered, not the thin layer on it") {
  constexpr Label kBone = 1, kLayer = 2, kFlesh = 3;
  LabelVolume volume;
  volume.grid.size = {19, 19, 19};
  volume.voxels.resize(volume.grid.voxel_count());
  for (int z = 0; z < 19; ++z)
    for (int y = 0; y < 19; ++y)
      for (int x = 0; x < 19; ++x) {
        const double r = glm::length(glm::dvec3(x, y, z) - 9.0);
        volume.at({x, y, z}) = r < 4 ? kBone : r < 5 ? kLayer : kFlesh;
      }
  LabelSet soft(65536, 1);
  soft[kBone] = 0;
  const LabelSampler sampler(volume);
  CHECK(sampler.nearest_of({9, 9, 9}, soft, 8) == kLayer);
  CHECK(sampler.prevailing({9, 9, 9}, soft, 8) == kFlesh);
  CHECK(sampler.prevailing({9, 9, 9}, soft, 2) == 0);
  LabelSet layer(65536, 0);
  layer[kLayer] = 1;
  CHECK(sampler.prevailing({9, 9, 9}, layer, 8) == kLayer);
}

TEST_CASE("label sampler: a point that is not a number, or far away, is air") {
  const LabelVolume volume = random_volume({3, 3, 3}, 2, 8);
  const LabelSampler sampler(volume);
  for (const double bad : {std::nan(""), 1e300, -1e300, double(INFINITY), -double(INFINITY)}) {
    CHECK(sampler.nearest({1, bad, 1}) == 0);
    CHECK(sampler.tissue({bad, 1, 1}) == 0);
    CHECK(sampler.tissue({1, 1, bad}, LabelSet(65536, 1)) == 0);
  }
}

namespace {
// Turns a volume by `degrees` about z through the point `centre`, and samples it on the grid of `to`. Coordinates are
// voxels of the original; voxel 0 of the turned volume lies at `from_shift`, voxel 0 of `to` at `to_shift`.
template <class Sample>
void turn(double degrees, const glm::dvec2& centre, const glm::dvec3& from_shift, const glm::dvec3& to_shift,
          LabelVolume& to, const Sample& sample) {
  const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
  parallel_for(to.grid.size.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (int z = static_cast<int>(begin); z < end; ++z)
      for (int y = 0; y < to.grid.size.y; ++y)
        for (int x = 0; x < to.grid.size.x; ++x) {
          const glm::dvec2 q = glm::dvec2(x + to_shift.x, y + to_shift.y) - centre;
          const glm::dvec2 p = glm::dvec2(c * q.x + s * q.y, c * q.y - s * q.x) + centre;
          to.at({x, y, z}) = sample(glm::dvec3(p, z + to_shift.z) - from_shift);
        }
  });
}

struct Agreement {
  double mean = 0, by_voxels = 0;
  std::map<Label, double> volume_ratio;
};

Agreement dice(const LabelVolume& a, const LabelVolume& b) {
  std::vector<std::array<double, 3>> count(65536);  // by label: voxels in a, in b, in both
  for (size_t i = 0; i < a.voxels.size(); ++i) {
    ++count[a.voxels[i]][0];
    ++count[b.voxels[i]][1];
    if (a.voxels[i] == b.voxels[i]) ++count[a.voxels[i]][2];
  }
  Agreement agreement;
  double labels = 0, voxels = 0;
  for (int label = 1; label < 65536; ++label) {
    const auto [in_a, in_b, both] = count[label];
    if (in_a < 100) continue;
    const double d = 2 * both / (in_a + in_b);
    agreement.mean += d;
    agreement.by_voxels += in_a * d;
    agreement.volume_ratio[label] = in_b / in_a;
    labels += 1;
    voxels += in_a;
  }
  agreement.mean /= labels;
  agreement.by_voxels /= voxels;
  return agreement;
}
}  // namespace

TEST_CASE("label sampler: the arm turned by 45 degrees and back agrees better than by any known interpolation" *
          doctest::test_suite("slow")) {
  NEEDS_SHARED("data/bender/man-arm-2mm.mha");
  const LabelVolume arm = read_volume(test::shared_path("data/bender/man-arm-2mm.mha")).volume;
  const glm::dvec2 centre = glm::dvec2(arm.grid.size.x - 1, arm.grid.size.y - 1) / 2.0;
  const int wide = arm.grid.size.x + arm.grid.size.y;
  const glm::dvec3 none(0), shift(-arm.grid.size.y / 2, -arm.grid.size.x / 2, 0);
  LabelVolume turned{{.size = {wide, wide, arm.grid.size.z}}, {}}, back{arm.grid, {}};
  turned.voxels.resize(turned.grid.voxel_count());
  back.voxels.resize(back.grid.voxel_count());

  const LabelSampler of_arm(arm), of_turned(turned);
  turn(45, centre, none, shift, turned, [&](const glm::dvec3& p) { return of_arm.tissue(p); });
  turn(-45, centre, shift, none, back, [&](const glm::dvec3& p) { return of_turned.tissue(p); });
  const Agreement agreement = dice(arm, back);
  CHECK(agreement.mean > 0.932);                                              // cubic B-splines reach 0.9270
  CHECK(agreement.by_voxels > 0.971);                                         // cubic B-splines reach 0.9691
  CHECK(agreement.volume_ratio.at(143) == doctest::Approx(1).epsilon(0.01));  // skin, which is one voxel thick
}
