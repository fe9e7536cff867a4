// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/flesh_cells.h"

#include <algorithm>
#include <bit>

#include "core/base/parallel.h"
#include "core/deform/cell_nodes.h"
#include "core/deform/cell_pieces.h"

namespace limber {

namespace {

// Upper limit on the number of cells, counted as if tissue filled each of them completely. The size of cells is chosen
// to meet this limit: a body of 3 mm voxels gets cells of 6 mm, a body of 2 mm voxels gets cells of 8 mm.
constexpr std::int64_t kMostCells = 250'000;
constexpr int kGrain = 1024;

glm::ivec3 corner_of(int i) { return {i & 1, i >> 1 & 1, i >> 2}; }

std::vector<std::int64_t> bending_bricks(const BrickMotions& motions) {
  std::vector<std::int64_t> bricks;
  for (std::int64_t b = 0; b < std::ssize(motions.around); ++b)
    if (motions.around[b] == BrickMotions::kSeveral) bricks.push_back(b);
  return bricks;
}

// Returns the smallest step (cell edge in voxels: 2, 4 or 8) that gives at most kMostCells cells; 8 if even that gives
// more.
int step_for(const TissueVoxels& tissue, std::span<const std::int64_t> bricks) {
  std::int64_t voxels = 0;
  for (const std::int64_t b : bricks) voxels += tissue.bricks()[b].count();
  int step = 2;
  while (step < TissueVoxels::kBrick && voxels > kMostCells * step * step * step) step *= 2;
  return step;
}

// Computes the blended position of each node, from the weights that all cells around the node give to it.
void blend_nodes(const std::vector<CellPiece>& pieces, const Grid& grid,
                 const std::vector<RigidTransform>& posed_from_rest, Blend blend, FleshCells& cells) {
  std::vector<std::int64_t> begin(cells.rest.size() + 1);
  for (std::size_t p = 0; p < pieces.size(); ++p)
    for (const CellPiece::Share& share : pieces[p].shares) ++begin[cells.nodes[p][share.corner] + 1];
  for (std::size_t n = 0; n < cells.rest.size(); ++n) begin[n + 1] += begin[n];
  std::vector<BoneWeight> influences(begin.back());
  std::vector<std::int64_t> end(begin.begin(), begin.end() - 1);
  for (std::size_t p = 0; p < pieces.size(); ++p)
    for (const CellPiece::Share& share : pieces[p].shares)
      influences[end[cells.nodes[p][share.corner]]++] = {share.bone, share.weight};
  const AffineTransform world = world_from_voxel(grid), voxel = voxel_from_world(grid);
  const auto bones = skin_transforms(posed_from_rest);
  parallel_for(std::ssize(cells.rest), kGrain, [&](std::int64_t first, std::int64_t last) {
    for (auto n = first; n < last; ++n) {
      std::sort(influences.begin() + begin[n], influences.begin() + begin[n + 1],
                [](const BoneWeight& a, const BoneWeight& b) {
                  return a.bone != b.bone ? a.bone < b.bone : a.weight < b.weight;
                });
      const glm::dvec3 rest = world * (cells.rest[n] / grid.spacing);
      const std::span<const BoneWeight> mine(&influences[begin[n]], static_cast<std::size_t>(begin[n + 1] - begin[n]));
      cells.blended[n] = (voxel * blend_point(blend, bones, mine, rest)) * grid.spacing;
    }
  });
}

// Returns true if a node touches a brick that moves as one rigid body. Such nodes are fixed.
bool is_beside_rigid(const TissueVoxels& tissue, const BrickMotions& motions, const glm::ivec3& lowest_voxel) {
  for (int c = 0; c < 8; ++c) {
    const glm::ivec3 v = lowest_voxel - corner_of(c);
    if (glm::any(glm::lessThan(v, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(v, tissue.grid_size()))) continue;
    const int brick = tissue.brick_at(v);
    if (brick >= 0 && motions.around[brick] != BrickMotions::kSeveral) return true;
  }
  return false;
}

void add_bone(const CellPiece& piece, const LabelVolume& volume, const LabelSet& is_bone,
              const std::array<std::int32_t, 8>& nodes, FleshCells& cells) {
  const double step = cells.step;
  for (int z = 0; z < 8; ++z)
    for (std::uint64_t bits = piece.voxels[z]; bits; bits &= bits - 1) {
      const int bit = std::countr_zero(bits);
      const glm::ivec3 in(bit & 7, bit >> 3, z);
      if (!is_bone[volume.at(piece.cell * cells.step + in)]) continue;
      const glm::dvec3 t = (glm::dvec3(in) + 0.5) / step;
      for (int i = 0; i < 8; ++i)
        cells.bone[nodes[i]] += static_cast<float>((i & 1 ? t.x : 1 - t.x) * (i & 2 ? t.y : 1 - t.y) *
                                                   (i & 4 ? t.z : 1 - t.z) / (step * step * step));
    }
}

}  // namespace

FleshCells flesh_cells(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                       const LabelSet& is_bone, const std::vector<RigidTransform>& posed_from_rest, Blend blend,
                       const BrickMotions& motions) {
  FleshCells cells;
  const std::vector<std::int64_t> bricks = bending_bricks(motions);
  cells.step = step_for(tissue, bricks);
  cells.edge = volume.grid.spacing * double(cells.step);
  cells.bending.assign(tissue.bricks().size(), -1);
  cells.cell_of_voxel.assign(512 * bricks.size(), -1);
  for (std::size_t i = 0; i < bricks.size(); ++i) cells.bending[bricks[i]] = static_cast<std::int32_t>(512 * i);

  const std::vector<CellPiece> pieces = cell_pieces(tissue, weights, cells.step, volume.grid.spacing, bricks);
  const CellNodes numbered = number_nodes(pieces, volume.grid.size, cells.step);
  const std::int32_t count = numbered.count;
  cells.nodes = numbered.of_piece;
  cells.rest.resize(count);
  cells.blended.resize(count);
  cells.bone.resize(count);
  cells.is_fixed.resize(count);
  cells.fill.resize(pieces.size());
  cells.lowest.resize(pieces.size());
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const CellPiece& piece = pieces[p];
    const glm::ivec3 lowest = cells.lowest[p] = piece.cell * cells.step;
    const std::int32_t first = cells.bending[tissue.brick_at(lowest)];
    const glm::ivec3 in_brick = lowest % TissueVoxels::kBrick;
    int voxels = 0;
    for (int z = 0; z < 8; ++z)
      for (std::uint64_t bits = piece.voxels[z]; bits; bits &= bits - 1, ++voxels) {
        const int bit = std::countr_zero(bits);
        const glm::ivec3 v = in_brick + glm::ivec3(bit & 7, bit >> 3, z);
        cells.cell_of_voxel[first + v.x + 8 * (v.y + 8 * v.z)] = static_cast<std::int32_t>(p);
      }
    cells.fill[p] = static_cast<float>(voxels) / static_cast<float>(cells.step * cells.step * cells.step);
    for (int i = 0; i < 8; ++i) {
      const std::int32_t node = cells.nodes[p][i];
      const glm::ivec3 corner = lowest + corner_of(i) * cells.step;
      cells.rest[node] = (glm::dvec3(corner) - 0.5) * volume.grid.spacing;
      cells.is_fixed[node] = is_beside_rigid(tissue, motions, corner);
    }
    add_bone(piece, volume, is_bone, cells.nodes[p], cells);
  }
  blend_nodes(pieces, volume.grid, posed_from_rest, blend, cells);
  return cells;
}

}  // namespace limber
