// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/deform/posed_bones.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace limber {

namespace {

constexpr double kBin = 16;  // edge of a search bin, in mean voxel edges
constexpr std::int64_t kMostBins = 4'000'000;
constexpr double kHalf = 0.5;  // voxels from the centre of a bone's outermost voxel to the bone's surface

}  // namespace

PosedBones::PosedBones(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                       const LabelSet& is_bone, const std::vector<RigidTransform>& posed_from_rest)
    : tissue_(&tissue),
      weights_(&weights),
      spacing_(volume.grid.spacing) {
  LabelVolume bones{volume.grid, ZeroedVector<Label>(volume.grid.voxel_count())};
  tissue.for_each([&](std::int64_t, const glm::ivec3& v) {
    if (is_bone[volume.at(v)]) bones.at(v) = 1;
  });
  bone_tissue_ = TissueVoxels(bones);
  if (bone_tissue_.size() == 0) return;
  depth_.emplace(bone_tissue_, spacing_);

  const AffineTransform world = world_from_voxel(volume.grid), voxel = voxel_from_world(volume.grid);
  const glm::dmat3 scale(spacing_.x, 0, 0, 0, spacing_.y, 0, 0, 0, spacing_.z), shrink = glm::inverse(scale);
  std::vector<AffineTransform> posed_from_rest_mm;
  const auto in_mm = [&](const RigidTransform& motion) {
    const glm::dmat3 turn = scale * voxel.linear * glm::mat3_cast(motion.rotation) * world.linear * shrink;
    return AffineTransform{turn, scale * (voxel * (motion * (world * glm::dvec3(0))))};
  };
  for (const RigidTransform& motion : posed_from_rest) {
    posed_from_rest_mm.push_back(in_mm(motion));
    turn_.push_back(posed_from_rest_mm.back().linear);
    rest_from_posed_.push_back(in_mm(inverse(motion)));
  }

  // Posed bounding box of the voxels of one bone in one brick.
  struct Around {
    int bone;
    glm::dvec3 low, high;
  };
  std::vector<Around> around;
  glm::dvec3 lowest(INFINITY), highest(-INFINITY);
  for (std::int64_t b = 0; b < std::ssize(bone_tissue_.bricks()); ++b) {
    std::map<int, std::pair<glm::dvec3, glm::dvec3>> boxes;
    bone_tissue_.for_each(b, b + 1, [&](std::int64_t, const glm::ivec3& v) {
      const int brick = tissue.brick_at(v),
                bone = weights.chunk(brick)[tissue.index_of(v) - tissue.bricks()[brick].first].bone[0];
      const glm::dvec3 posed = posed_from_rest_mm[bone] * (glm::dvec3(v) * spacing_);
      auto [box, is_new] = boxes.try_emplace(bone, posed, posed);
      box->second = {glm::min(box->second.first, posed), glm::max(box->second.second, posed)};
    });
    for (const auto& [bone, box] : boxes) {
      const double reach = glm::length(spacing_);
      around.push_back({bone, box.first - reach, box.second + reach});
      lowest = glm::min(lowest, around.back().low);
      highest = glm::max(highest, around.back().high);
    }
  }
  bin_ = kBin * (spacing_.x + spacing_.y + spacing_.z) / 3;
  first_ = lowest;
  for (;; bin_ *= 2) {
    const glm::dvec3 count = glm::floor((highest - lowest) / bin_) + 1.0;
    bins_ = glm::ivec3(glm::min(count, 1e6));
    if (double(bins_.x) * bins_.y * bins_.z <= double(kMostBins)) break;
  }
  std::vector<Box> boxes;
  for (const Around& each : around)
    boxes.push_back({each.bone, bin_of(each.low), glm::min(bin_of(each.high), bins_ - 1)});
  fill_bins(boxes);
}

void PosedBones::fill_bins(const std::vector<Box>& boxes) {
  std::vector<std::vector<std::int16_t>> all(std::size_t(bins_.x) * bins_.y * bins_.z);
  for (const Box& box : boxes)
    for (int z = box.low.z; z <= box.high.z; ++z)
      for (int y = box.low.y; y <= box.high.y; ++y)
        for (int x = box.low.x; x <= box.high.x; ++x) {
          auto& bin = all[x + std::size_t(bins_.x) * (y + std::size_t(bins_.y) * z)];
          const auto at = std::lower_bound(bin.begin(), bin.end(), box.bone);
          if (at == bin.end() || *at != box.bone) bin.insert(at, static_cast<std::int16_t>(box.bone));
        }
  begin_.push_back(0);
  for (const auto& bin : all) {
    bones_.insert(bones_.end(), bin.begin(), bin.end());
    begin_.push_back(static_cast<std::int32_t>(bones_.size()));
  }
}

// Returns true if the voxel at a rest point is bone tissue that follows the given bone.
//   rest  voxel coordinates
bool PosedBones::holds(int bone, const glm::dvec3& rest) const {
  const glm::ivec3 voxel(glm::floor(rest + 0.5));
  if (glm::any(glm::lessThan(voxel, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(voxel, tissue_->grid_size())))
    return false;
  if (bone_tissue_.brick_at(voxel) < 0 || bone_tissue_.index_of(voxel) < 0) return false;
  const int brick = tissue_->brick_at(voxel);
  return weights_->chunk(brick)[tissue_->index_of(voxel) - tissue_->bricks()[brick].first].bone[0] == bone;
}

std::optional<glm::dvec3> PosedBones::way_out(const glm::dvec3& posed) const {
  if (!depth_) return std::nullopt;
  const glm::ivec3 bin = bin_of(posed);
  if (glm::any(glm::lessThan(bin, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(bin, bins_))) return std::nullopt;
  const auto at = bin.x + std::size_t(bins_.x) * (bin.y + std::size_t(bins_.y) * bin.z);
  const double surface = kHalf * std::min({spacing_.x, spacing_.y, spacing_.z});
  for (std::int32_t i = begin_[at]; i < begin_[at + 1]; ++i) {
    const int bone = bones_[i];
    const glm::dvec3 rest = (rest_from_posed_[bone] * posed) / spacing_;
    if (!holds(bone, rest)) continue;
    const double deep = (*depth_)(rest)-surface;
    if (deep <= 0) continue;
    glm::dvec3 slope;
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0);
      step[axis] = 1;
      slope[axis] = ((*depth_)(rest + step) - (*depth_)(rest - step)) / (2 * spacing_[axis]);
    }
    if (const double steep = glm::length(slope); steep > 0.1) return turn_[bone] * (slope * (-deep / steep));
  }
  return std::nullopt;
}

}  // namespace limber
