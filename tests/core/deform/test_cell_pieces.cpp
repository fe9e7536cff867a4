// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/cell_pieces.h"

#include <bit>

#include <doctest/doctest.h>

#include "core/volume/label_volume.h"

using namespace limber;

namespace {

// Two bars along z with air between them, joined at the bottom.
LabelVolume fork(int gap) {
  LabelVolume volume{Grid{}, {}};
  volume.grid.size = {24, 16, 40};
  volume.voxels.resize(24 * 16 * 40);
  for (int z = 2; z < 38; ++z)
    for (int y = 4; y < 12; ++y)
      for (int x = 2; x < 14 + gap; ++x)
        if (z < 5 || x < 8 || x >= 8 + gap) volume.voxels[x + 24 * (y + 16 * z)] = 1;
  return volume;
}

}  // namespace

TEST_CASE("cell pieces: what touches by faces within a cell is one piece, and every voxel lies in one") {
  for (const int step : {2, 4, 8}) {
    const LabelVolume volume = fork(1);
    const TissueVoxels tissue(volume);
    const SkinWeights weights({"A"}, tissue);
    const auto pieces = cell_pieces(tissue, weights, step, glm::dvec3(1));
    const PiecesByCell by_cell(pieces, glm::ivec3(-1), (volume.grid.size + step - 1) / step + 2);
    std::int64_t voxels = 0;
    double shares = 0;
    for (const CellPiece& piece : pieces) {
      for (const std::uint64_t slice : piece.voxels) voxels += std::popcount(slice);
      for (const CellPiece::Share& share : piece.shares) shares += share.weight;
      CHECK(piece.places != 0);
      REQUIRE(piece.stiff.size() == 1);
      CHECK(piece.stiff[0].places == piece.places);
    }
    CHECK(voxels == tissue.size());
    // The weights of each voxel over the corners of its cell sum to kFullWeight.
    CHECK(shares == doctest::Approx(1000.0 * kFullWeight * double(tissue.size())).epsilon(1e-4));
    // The gap lies at x = 8, where a cell begins, so the pieces in the cells on its two sides do not touch.
    const glm::ivec3 beside(8 / step, 8 / step, 24 / step);
    REQUIRE(by_cell.of(beside).size() == 1);
    REQUIRE(by_cell.of(beside - glm::ivec3(1, 0, 0)).size() == 1);
    CHECK_FALSE(touch(by_cell.of(beside - glm::ivec3(1, 0, 0))[0], by_cell.of(beside)[0], 0, step));
    CHECK(touch(by_cell.of(beside)[0], by_cell.of(beside + glm::ivec3(0, 0, 1))[0], 2, step));
    CHECK(by_cell.of({-5, 0, 0}).empty());
  }
}

TEST_CASE("cell pieces: bars that pass through one cell side by side are two pieces of it") {
  LabelVolume volume = fork(1);
  for (int z = 2; z < 38; ++z)
    for (int y = 4; y < 12; ++y) {
      volume.voxels[8 + 24 * (y + 16 * z)] = 1;
      if (z >= 5) volume.voxels[10 + 24 * (y + 16 * z)] = 0;
    }
  const TissueVoxels tissue(volume);
  const SkinWeights weights({"A"}, tissue);
  const auto pieces = cell_pieces(tissue, weights, 4, glm::dvec3(1));
  const PiecesByCell by_cell(pieces, glm::ivec3(-1), glm::ivec3(8, 6, 12));
  CHECK(by_cell.of({2, 2, 6}).size() == 2);  // a piece at x = 8 and 9, and a piece at x = 11
  CHECK(by_cell.of({2, 2, 0}).size() == 1);
}
