// SPDX-License-Identifier: AGPL-3.0-or-later
// A seam separates the cells of both lattices: the one for resampling and the one for the preview.
#include <bit>

#include <doctest/doctest.h>

#include "core/deform/cell_pieces.h"
#include "core/deform/lattice.h"

using namespace limber;

namespace {

// A bar of 16 x 8 x 8 voxels. The first seven columns follow bone 0, the others bone 1, with a seam between them below
// a given height.
struct Bar {
  static constexpr int kLeft = 6;  // last column of bone 0
  LabelVolume volume;
  TissueVoxels tissue;
  SkinWeights weights;

  explicit Bar(int cut_below) {
    volume.grid.size = {16, 8, 8};
    volume.voxels.assign(volume.grid.voxel_count(), 1);
    tissue = TissueVoxels(volume);
    weights = SkinWeights({"left", "right"}, tissue);
    for (std::int64_t brick = 0; brick < weights.chunk_count(); ++brick) {
      SkinWeights::Influences chunk;
      tissue.for_each(brick, brick + 1,
                      [&](std::int64_t, const glm::ivec3& v) { chunk.push_back(rigid_influence(v.x > kLeft)); });
      weights.set_chunk(brick, chunk);
    }
    auto seams = std::make_shared<Seams>(volume.grid.size);
    for (int z = 0; z < cut_below; ++z)
      for (int y = 0; y < 8; ++y) seams->cut({kLeft, y, z}, 0);
    tissue.set_seams(seams);
  }
};

// Returns true if the posed corners of some cell are further apart along x than `longest` voxels.
bool has_long_cell(const PosedLattice& lattice, double longest) {
  bool found = false;
  for (std::int64_t brick = 0; brick < std::ssize(lattice.tissue().bricks()); ++brick) {
    if (!lattice.is_split(brick)) continue;
    auto corners = std::make_unique<PosedLattice::SplitBrick>();
    lattice.split_corners(brick, *corners);
    for (int cell = 0; cell < 512; ++cell)
      for (int c = 0; c < 8; c += 2)
        found |= std::abs((*corners)[8 * cell + c + 1].x - (*corners)[8 * cell + c].x) > longest * kFixedOne;
  }
  return found;
}

}  // namespace

TEST_CASE("seams in lattices: two sides that move apart share no vertex, and where the seam ends they do") {
  const std::vector<RigidTransform> apart = {{}, {glm::dquat(1, 0, 0, 0), {10, 0, 0}}};
  const Bar whole(8), half(4);
  const PosedLattice cut(whole.volume, whole.tissue, whole.weights, apart, Blend::Linear, glm::dvec3(1));
  CHECK(cut.is_split(0));
  CHECK_FALSE(has_long_cell(cut, 1.001));
  const PosedLattice partly(half.volume, half.tissue, half.weights, apart, Blend::Linear, glm::dvec3(1));
  CHECK(has_long_cell(partly, 4));
}

TEST_CASE("seams in lattices: a cell of the preview that a seam runs through is two pieces, which do not touch") {
  for (const int step : {4, 8}) {
    const Bar bar(8);
    const auto pieces = cell_pieces(bar.tissue, bar.weights, step, glm::dvec3(1));
    std::int64_t voxels = 0;
    for (const CellPiece& piece : pieces) {
      for (const std::uint64_t slice : piece.voxels) voxels += std::popcount(slice);
      CHECK(piece.stiff.size() == 1);  // each piece follows one bone
    }
    CHECK(voxels == bar.tissue.size());
    CHECK(std::ssize(pieces) == (step == 8 ? 3 : 4 * 4 + 4));
  }
  // Here the seam lies on the border of two cells.
  Bar bar(0);
  auto seams = std::make_shared<Seams>(bar.volume.grid.size);
  for (int z = 0; z < 8; ++z)
    for (int y = 0; y < 8; ++y) seams->cut({7, y, z}, 0);
  bar.tissue.set_seams(seams);
  const auto pieces = cell_pieces(bar.tissue, bar.weights, 8, glm::dvec3(1));
  REQUIRE(pieces.size() == 2);
  CHECK_FALSE(touch(pieces[0], pieces[1], 0, 8));
  bar.tissue.set_seams(nullptr);
  const auto joined = cell_pieces(bar.tissue, bar.weights, 8, glm::dvec3(1));
  CHECK(touch(joined[0], joined[1], 0, 8));
}
