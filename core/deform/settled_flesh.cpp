// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/settled_flesh.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/deform/volume_shifts.h"

namespace limber {

namespace {

constexpr float kNothing = 1e-3f;  // voxels: what rounding alone would shift

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

// Trilinear in the cell; `corner` is its own.
glm::vec3 SettledFlesh::shift_in(std::int32_t cell, const glm::ivec3& corner) const {
  const auto& nodes = cells_.nodes[cell];
  const glm::ivec3 first = glm::ivec3(glm::round(cells_.rest[nodes[0]] * (double(cells_.step) / cells_.edge) + 0.5));
  const glm::vec3 t = glm::vec3(corner - first) / float(cells_.step);
  glm::vec3 shift(0);
  for (int i = 0; i < 8; ++i)
    shift += shift_[nodes[i]] * ((i & 1 ? t.x : 1 - t.x) * (i & 2 ? t.y : 1 - t.y) * (i & 4 ? t.z : 1 - t.z));
  return shift;
}

// -1 in air, and where tissue moves as one.
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
  glm::vec3 sum(0);
  int count = 0;
  bool is_rigid = false;
  for (; around; around &= around - 1) {
    const int v = std::countr_zero(around);
    const std::int32_t cell = cell_at(lowest + glm::ivec3(v & 1, v >> 1 & 1, v >> 2), is_rigid);
    if (is_rigid) return glm::vec3(0);
    if (cell < 0) continue;
    sum += shift_in(cell, lowest + 1);
    ++count;
  }
  return count ? sum / float(count) : glm::vec3(0);
}

bool SettledFlesh::corner_shifts(std::int64_t brick, CornerShifts& shifts) const {
  if (cells_.bending[brick] < 0) return false;
  const glm::ivec3 lowest = tissue_->bricks()[brick].corner - 1;
  std::size_t at = 0;
  for (int k = 0; k <= 8; ++k)
    for (int j = 0; j <= 8; ++j)
      for (int i = 0; i <= 8; ++i) shifts[at++] = corner_shift(lowest + glm::ivec3(i, j, k), 0xff);
  return true;
}

}  // namespace limber
