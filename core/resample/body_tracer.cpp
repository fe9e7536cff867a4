// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/body_tracer.h"

namespace limber {

namespace {

constexpr int kBin = 32;  // edge of a bin, output voxels; a brick of 8 voxels reaches one or two bins along each axis

template <class BoxOf>
BoxBins bins_of(std::int64_t count, const VoxelRange& output, const BoxOf& box_of) {
  std::vector<VoxelRange> boxes(count);
  for (std::int64_t i = 0; i < count; ++i) boxes[i] = intersect(box_of(i), output);
  return {std::move(boxes), kBin};
}

}  // namespace

BodyTracer::BodyTracer(const PosedLattice& lattice, const RigidBones& bones, const PosedTets* tets,
                       const TissueDepth* depth, const std::vector<int>& priority, const LabelSampler& sampler,
                       const VoxelRange& output, bool nearest)
    : lattice_(lattice),
      bones_(bones),
      tets_(tets),
      depth_(depth),
      priority_(priority),
      sampler_(sampler),
      nearest_(nearest) {
  bricks_ = bins_of(std::ssize(lattice.tissue().bricks()), output, [&](std::int64_t brick) {
    const auto& box = lattice.bounds(brick);
    return VoxelRange{box.low >> 16, (box.high + (kFixedOne - 1)) >> 16};
  });
  pieces_ = bins_of(std::ssize(bones.pieces()), output, [&](std::int64_t i) { return bones.pieces()[i].posed; });
}

bool BodyTracer::fill(InverseMap& map, const VoxelRange& range, bool even_if_empty) const {
  std::vector<std::int64_t> bricks, pieces;
  bricks_.meeting(range, bricks);
  pieces_.meeting(range, pieces);
  const bool has_tets = tets_ && tets_->reaches(range);
  if (bricks.empty() && pieces.empty() && !has_tets && !even_if_empty) return false;
  map.reset(range);
  if (has_tets) tets_->rasterize(map, priority_, depth_);
  rasterize_cells(map, lattice_, bricks, priority_, depth_, tets_ ? &tets_->instead_of() : nullptr);
  if (has_tets) tets_->rasterize_riders(map, priority_, depth_);
  bones_.paint(map, pieces, sampler_, nearest_, depth_);
  return true;
}

}  // namespace limber
