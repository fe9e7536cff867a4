// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/label_sampler.h"

#include <random>

#include <doctest/doctest.h>

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
