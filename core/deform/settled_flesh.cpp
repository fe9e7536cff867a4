// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/settled_flesh.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/deform/volume_shifts.h"

namespace limber {

namespace {

constexpr float kNothing = 1e-3f;  // in voxels: smaller shifts are rounding errors and are set to zero

}  // namespace

SettledFlesh::SettledFlesh(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                           const LabelSet& is_bone, const std::vector<RigidTransform>& posed_from_rest, Blend blend,
                           Progress& progress)
    : tissue_(&tissue) {
  progress.update("flesh", 0);
  const BrickMotions motions(tissue, weights, posed_from_rest);
  cells_ = flesh_cells(volume, tissue, weights, is_bone, posed_from_rest, blend, motions);
  const PosedBones bones(volume, tissue, weights, is_bone, posed_from_rest);
  const TissueDepth depth(tissue, volume.grid.spacing);
  FleshContact contact(cells_, depth, volume.grid.spacing);
  const VolumeShifts found = volume_shifts(cells_, &bones, &contact, progress);
  shift_.resize(found.shift.size());
  for (std::size_t n = 0; n < shift_.size(); ++n) {
    shift_[n] = found.shift[n] / glm::vec3(volume.grid.spacing);
    if (glm::length(shift_[n]) < kNothing) shift_[n] = glm::vec3(0);
    report_.largest_shift_mm = std::max<double>(report_.largest_shift_mm, glm::length(found.shift[n]));
  }
  report_.cells = std::ssize(cells_.nodes);
  report_.volume_error_before = found.error_before;
  report_.volume_error_after = found.error_after;
  progress.update("flesh", 1);
}

// Returns the trilinear weights of a cell's nodes at a voxel corner. They are in the order of the nodes' indices in the
// cell, so that two cells that share a face list the same nodes in the same order.
SettledFlesh::Shares SettledFlesh::shares_in(std::int32_t cell, const glm::ivec3& corner) const {
  const glm::ivec3 at = corner - cells_.lowest[cell];
  const float step = 1 / static_cast<float>(cells_.step);
  const glm::vec3 high = glm::vec3(at) * step, low = 1.0f - high;
  Shares shares;
  for (int i = 0; i < 8; ++i) {
    const float share = (i & 1 ? high.x : low.x) * (i & 2 ? high.y : low.y) * (i & 4 ? high.z : low.z);
    if (share == 0) continue;
    shares.node[shares.count] = cells_.nodes[cell][i];
    shares.share[shares.count++] = share;
  }
  return shares;
}

// Returns the cell that contains a voxel; -1: the voxel is air, or its brick moves as one rigid body. Only in the
// second case sets is_rigid.
std::int32_t SettledFlesh::cell_at(const glm::ivec3& voxel, bool& is_rigid) const {
  if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(voxel, tissue_->grid_size())))
    return -1;
  const int brick = tissue_->brick_at(voxel);
  if (brick < 0) return -1;
  const glm::ivec3 in = voxel & 7;
  if (cells_.bending[brick] < 0) {
    is_rigid = is_rigid || (tissue_->bricks()[brick].mask[in.z] >> (in.x + 8 * in.y) & 1);
    return -1;
  }
  return cells_.cell_of(brick, in);
}

glm::vec3 SettledFlesh::corner_shift(const glm::ivec3& lowest, unsigned around) const {
  std::array<std::int32_t, 8> cells;
  int count = 0;
  bool is_rigid = false;
  for (; around; around &= around - 1) {
    const int v = std::countr_zero(around);
    const std::int32_t cell = cell_at(lowest + glm::ivec3(v & 1, v >> 1 & 1, v >> 2), is_rigid);
    if (is_rigid) return glm::vec3(0);
    if (cell >= 0) cells[count++] = cell;
  }
  return count ? mean_shift({cells.data(), static_cast<std::size_t>(count)}, lowest + 1) : glm::vec3(0);
}

// Returns the mean shift of all `cells` at a voxel corner that they share. Most of these cells have the same nodes at
// the corner, and so the same shift.
glm::vec3 SettledFlesh::mean_shift(std::span<const std::int32_t> cells, const glm::ivec3& corner) const {
  const Shares first = shares_in(cells[0], corner);
  const auto shift_of = [&](const Shares& shares) {
    glm::vec3 shift(0);
    for (int i = 0; i < shares.count; ++i) shift += shift_[shares.node[i]] * shares.share[i];
    return shift;
  };
  glm::vec3 sum(0);
  int others = 0;
  for (std::size_t c = 1; c < cells.size(); ++c) {
    if (cells[c] == cells[0]) continue;
    const Shares shares = shares_in(cells[c], corner);
    if (shares.same_nodes(first)) continue;
    sum += shift_of(shares);
    ++others;
  }
  const glm::vec3 own = shift_of(first);
  return others ? (sum + own * float(std::ssize(cells) - others)) / float(std::ssize(cells)) : own;
}

bool SettledFlesh::corner_shifts(std::int64_t brick, CornerShifts& shifts) const {
  if (cells_.bending[brick] < 0) return false;
  constexpr int kHalo = TissueVoxels::kBrick + 2;  // edge of a brick with a border one voxel wide
  constexpr std::int32_t kRigid = -2;
  std::array<std::int32_t, kHalo * kHalo * kHalo> cells;
  const glm::ivec3 lowest = tissue_->bricks()[brick].corner - 1;
  std::size_t at = 0;
  for (int k = 0; k < kHalo; ++k)
    for (int j = 0; j < kHalo; ++j)
      for (int i = 0; i < kHalo; ++i) {
        bool is_rigid = false;
        const std::int32_t cell = cell_at(lowest + glm::ivec3(i, j, k), is_rigid);
        cells[at++] = is_rigid ? kRigid : cell;
      }
  at = 0;
  for (int k = 0; k <= 8; ++k)
    for (int j = 0; j <= 8; ++j)
      for (int i = 0; i <= 8; ++i) {
        std::array<std::int32_t, 8> around;
        std::size_t count = 0;
        bool is_rigid = false;
        for (int v = 0; v < 8; ++v) {
          const std::int32_t cell = cells[i + (v & 1) + kHalo * (j + (v >> 1 & 1) + kHalo * (k + (v >> 2)))];
          is_rigid = is_rigid || cell == kRigid;
          if (cell >= 0) around[count++] = cell;
        }
        shifts[at++] =
            count && !is_rigid ? mean_shift({around.data(), count}, lowest + 1 + glm::ivec3(i, j, k)) : glm::vec3(0);
      }
  return true;
}

}  // namespace limber
