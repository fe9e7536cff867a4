// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/output_grid.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"

namespace limber {

namespace {

// Upper limit on the number of output voxels, as a multiple of the number of input voxels. Arms that are raised from
// the sides to above the head need some ten times as many voxels. A pose beyond the limit means that the rig or the
// pose is broken.
constexpr std::int64_t kLargestGrowth = 24;
// Number of output voxels that is always allowed, however small the input is.
constexpr std::int64_t kAlwaysAllowed = std::int64_t{1} << 27;

VoxelRange united(const VoxelRange& a, const VoxelRange& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {glm::min(a.low, b.low), glm::max(a.high, b.high)};
}

VoxelRange posed_tissue(const PosedLattice& lattice, const RigidBones& bones, const PosedTets* tets) {
  VoxelRange range = tets ? tets->posed_tissue() : VoxelRange{};
  for (std::int64_t brick = 0; brick < std::ssize(lattice.tissue().bricks()); ++brick) {
    if (tets && tets->shares(brick)) continue;
    const auto& box = lattice.bounds(brick);
    // Rounds like the rasterizer: a sliver of tissue between two voxel centres gets the nearer voxel.
    const VoxelRange voxels{(box.low + (kFixedOne - 1)) >> 16, box.high >> 16};
    range = united(range, {glm::min(voxels.low, voxels.high), glm::max(voxels.low, voxels.high)});
  }
  for (const auto& piece : bones.pieces()) range = united(range, piece.posed_centres);
  return range;
}

VoxelRange rest_tissue(const TissueVoxels& tissue) {
  VoxelRange range;
  for (const TissueVoxels::Brick& brick : tissue.bricks()) {
    std::uint64_t columns = 0;  // bit x + 8 y: 1 if the brick has tissue at (x, y) in at least one slice
    int lowest = TissueVoxels::kBrick, highest = 0;
    for (int z = 0; z < TissueVoxels::kBrick; ++z) {
      if (!brick.mask[z]) continue;
      columns |= brick.mask[z];
      lowest = std::min(lowest, z);
      highest = z;
    }
    unsigned row = 0;  // bit x: 1 if the brick has tissue at x in at least one row
    for (int y = 0; y < TissueVoxels::kBrick; ++y) row |= columns >> (8 * y) & 0xff;
    range =
        united(range, {brick.corner + glm::ivec3(std::countr_zero(row), std::countr_zero(columns) / 8, lowest),
                       brick.corner + glm::ivec3(std::bit_width(row) - 1, (std::bit_width(columns) - 1) / 8, highest)});
  }
  return range;
}

std::string text(const glm::ivec3& size) {
  return std::to_string(size.x) + " x " + std::to_string(size.y) + " x " + std::to_string(size.z);
}

}  // namespace

glm::dvec3 spacing_ratio(const Grid& grid, double spacing) {
  glm::dvec3 ratio;
  for (int axis = 0; axis < 3; ++axis) ratio[axis] = grid.spacing[axis] == spacing ? 1.0 : grid.spacing[axis] / spacing;
  return ratio;
}

OutputGrid output_grid(const PosedLattice& lattice, const RigidBones& bones, const PosedTets* tets) {
  const Grid& input = lattice.volume().grid;
  const OutputLattice& output = lattice.output();
  const VoxelRange whole{glm::ivec3(0), input.size - 1}, tissue = rest_tissue(lattice.tissue());
  auto in_output = [&](const glm::ivec3& voxels) {
    return glm::ivec3(glm::ceil(glm::dvec3(voxels) * output.ratio - 1e-9));
  };

  OutputGrid result;
  if (tissue.empty()) {
    result.range = {glm::ivec3(0), glm::max(in_output(input.size), glm::ivec3(1)) - 1};
  } else {
    const VoxelRange posed = posed_tissue(lattice, bones, tets);
    result.range = {posed.low - in_output(tissue.low - whole.low), posed.high + in_output(whole.high - tissue.high)};
  }
  const glm::ivec3 size = result.range.high - result.range.low + 1;
  const double voxels = double(size.x) * size.y * size.z;
  if (voxels > double(std::max(kAlwaysAllowed, kLargestGrowth * input.voxel_count())))
    throw Error("the posed body needs a grid of " + text(size) + " voxels", "input grid of " + text(input.size),
                "check the pose and the weights, or use a coarser spacing");

  result.grid.size = size;
  result.grid.spacing = input.spacing / output.ratio;
  result.grid.direction = input.direction;
  result.grid.origin = world_from_voxel(input) * output.to_rest(glm::dvec3(result.range.low));
  return result;
}

}  // namespace limber
