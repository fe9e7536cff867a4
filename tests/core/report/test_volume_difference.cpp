// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/volume_difference.h"

#include <doctest/doctest.h>

#include "core/base/parallel.h"

using namespace limber;

namespace {

LabelVolume volume_of(const glm::ivec3& size, double spacing = 1) {
  return {{.size = size, .spacing = glm::dvec3(spacing)},
          ZeroedVector<Label>(static_cast<std::size_t>(size.x) * size.y * size.z)};
}

void fill(LabelVolume& volume, const glm::ivec3& low, const glm::ivec3& high, Label label) {
  for (int z = low.z; z < high.z; ++z)
    for (int y = low.y; y < high.y; ++y)
      for (int x = low.x; x < high.x; ++x) volume.at({x, y, z}) = label;
}

}  // namespace

TEST_CASE("volume difference: voxels with another tissue and with none there are counted by tissue, from either side") {
  LabelVolume a = volume_of({20, 20, 20}), b = a;
  fill(a, {2, 2, 2}, {12, 12, 12}, 1);
  fill(b, {4, 2, 2}, {14, 12, 12}, 1);
  fill(b, {4, 2, 2}, {6, 12, 12}, 2);
  const TissueVoxels in_a(a), in_b(b);
  const DifferingSide from_a = differing(a, in_a, b), from_b = differing(b, in_b, a);
  // Of four layers of 100 voxels, two became tissue 2, and two became air.
  CHECK(from_a.counts.at(1) == DifferingSide::Count{200, 200});
  CHECK(from_b.counts.at(1) == DifferingSide::Count{0, 200});
  CHECK(from_b.counts.at(2) == DifferingSide::Count{200, 0});
  CHECK(from_a.total.both() == 400);
  CHECK(from_a.voxels[static_cast<std::size_t>(in_a.index_of({2, 5, 5}))] == Differs::Air);
  CHECK(from_a.voxels[static_cast<std::size_t>(in_a.index_of({5, 5, 5}))] == Differs::Tissue);
  CHECK(from_a.voxels[static_cast<std::size_t>(in_a.index_of({8, 5, 5}))] == Differs::Not);
  CHECK(differing(a, in_a, a).total.both() == 0);
  const ThreadCount one(1);
  CHECK(differing(a, in_a, b) == from_a);
}

TEST_CASE("volume difference: volumes are held against one another in the world, whatever their grids") {
  LabelVolume a = volume_of({24, 24, 24});
  fill(a, {4, 4, 4}, {12, 12, 12}, 3);
  // The same body on a grid with another origin, whose x axis is reversed.
  LabelVolume shifted = volume_of({30, 26, 24});
  shifted.grid.origin = {26, -2, 0};
  shifted.grid.direction[0] = {-1, 0, 0};
  for (int z = 4; z < 12; ++z)
    for (int y = 4; y < 12; ++y)
      for (int x = 4; x < 12; ++x) shifted.at({26 - x, y + 2, z}) = 3;
  CHECK(differing(a, TissueVoxels(a), shifted).total.both() == 0);
  CHECK(differing(shifted, TissueVoxels(shifted), a).total.both() == 0);
  // The same box in voxels twice as wide, 4 along each axis.
  LabelVolume coarse = volume_of({12, 12, 12}, 2);
  coarse.grid.origin = glm::dvec3(0.5);
  fill(coarse, {2, 2, 2}, {6, 6, 6}, 3);
  CHECK(differing(a, TissueVoxels(a), coarse).total.both() == 0);
  // Outside the other grid, voxels count as air.
  const LabelVolume small = volume_of({4, 4, 4});
  CHECK(differing(a, TissueVoxels(a), small).counts.at(3) == DifferingSide::Count{0, 512});
}
