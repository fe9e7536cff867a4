// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bake/joint_corners.h"

#include <algorithm>
#include <numeric>

#include "core/base/parallel.h"
#include "core/deform/brick_motions.h"
#include "core/deform/corner_weights.h"
#include "core/deform/posed_tets.h"

namespace limber {

namespace {

constexpr int kBrick = TissueVoxels::kBrick;

// Returns a byte per brick of voxels: 1 if tissue in this brick or in a neighbouring one is bent by the joint or
// meshed.
std::vector<std::uint8_t> bricks_around_joint(const TissueVoxels& tissue, const SkinWeights& weights,
                                              const std::vector<std::vector<RigidTransform>>& motions,
                                              const std::vector<const TissueMask*>& meshed) {
  const std::int64_t count = std::ssize(tissue.bricks());
  std::vector<std::uint8_t> own(count, 0), around(count, 0);
  for (const auto& pose : motions) {
    const BrickMotions bricks(tissue, weights, pose);
    for (std::int64_t b = 0; b < count; ++b) own[b] |= bricks.around[b] == BrickMotions::kSeveral;
  }
  for (const TissueMask* mask : meshed)
    for (std::int64_t b = 0; b < count; ++b)
      for (const std::uint64_t slice : (*mask)[b]) own[b] |= slice != 0;
  for (std::int64_t b = 0; b < count; ++b) {
    if (!own[b]) continue;
    const glm::ivec3 here = tissue.bricks()[b].corner / kBrick;
    const glm::ivec3 low = glm::max(here - 1, glm::ivec3(0)), high = glm::min(here + 1, tissue.brick_grid() - 1);
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x)
          if (const int near = tissue.brick_at(glm::ivec3(x, y, z) * kBrick); near >= 0) around[near] = 1;
  }
  return around;
}

std::int64_t place_of(const glm::ivec3& corner, const Grid& grid) {
  return corner.x + (grid.size.x + std::int64_t{1}) * (corner.y + (grid.size.y + std::int64_t{1}) * corner.z);
}

// Calls body(voxel) for each of the up to eight tissue voxels that have this corner.
template <class Body>
void for_each_around(const TissueVoxels& tissue, const glm::ivec3& corner, const Body& body) {
  for (int i = 0; i < 8; ++i) {
    const glm::ivec3 v = corner - glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
    if (glm::any(glm::lessThan(v, glm::ivec3(0))) || glm::any(glm::greaterThanEqual(v, tissue.grid_size()))) continue;
    if (tissue.holds(v)) body(v);
  }
}

}  // namespace

JointCorners joint_corners(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                           const LabelSet& is_bone, const LabelSet& is_skin,
                           const std::vector<std::vector<RigidTransform>>& motions,
                           const std::vector<const TissueMask*>& meshed) {
  const std::vector<std::uint8_t> taken = bricks_around_joint(tissue, weights, motions, meshed);
  std::vector<int> itself(weights.bones().size());
  std::iota(itself.begin(), itself.end(), 0);
  const AffineTransform to_world = world_from_voxel(volume.grid);
  JointCorners corners;
  corners.offsets.push_back(0);
  for (std::int64_t b = 0; b < std::ssize(taken); ++b) {
    if (!taken[b]) continue;
    CornerWeights influences(tissue, weights, itself, b);
    for (int at = 0; at < 9 * 9 * 9; ++at) {
      const glm::ivec3 in(at % 9, at / 9 % 9, at / 81), corner = tissue.bricks()[b].corner + in;
      // A corner that several bricks share is listed once: by the first brick around the joint that has a tissue voxel
      // at the corner.
      std::int64_t lister = -1;
      bool is_soft = false, is_skinned = false;
      for_each_around(tissue, corner, [&](const glm::ivec3& v) {
        const int brick = tissue.brick_at(v);
        if (taken[brick] && (lister < 0 || brick < lister)) lister = brick;
        is_soft |= !is_bone[volume.at(v)];
        is_skinned |= is_skin[volume.at(v)] != 0;
      });
      if (lister != b) continue;
      corners.corner.push_back(corner);
      corners.rest.push_back(to_world * (glm::dvec3(corner) - 0.5));
      const std::span<const BoneWeight> given = influences.at(in);
      corners.influences.insert(corners.influences.end(), given.begin(), given.end());
      corners.offsets.push_back(std::ssize(corners.influences));
      corners.is_soft.push_back(is_soft);
      corners.is_skin.push_back(is_skinned);
    }
  }
  return corners;
}

std::vector<glm::dvec3> blended_corners(const JointCorners& corners, const std::vector<RigidTransform>& motions) {
  std::vector<glm::dvec3> posed(corners.size());
  const std::vector<SkinTransform> bones = skin_transforms(motions);
  parallel_for(corners.size(), 4096, [&](std::int64_t begin, std::int64_t end) {
    for (auto c = begin; c < end; ++c)
      posed[c] = blend_point(
          Blend::DualQuaternion, bones,
          std::span(corners.influences).subspan(corners.offsets[c], corners.offsets[c + 1] - corners.offsets[c]),
          corners.rest[c]);
  });
  return posed;
}

CarriedCorners::CarriedCorners(const JointCorners& corners, const LabelVolume& volume, const TissueVoxels& tissue,
                               const SkinWeights& weights, const DeformingRegion& moving,
                               std::shared_ptr<const TetMesh> mesh, double furthest_mm)
    : corners_(corners),
      volume_(volume),
      tissue_(tissue),
      weights_(with_rigid_rest(weights, tissue, moving)),
      moving_(moving),
      mesh_(std::move(mesh)) {
  std::vector<PointToCarry> points;
  for (std::int64_t c = 0; c < corners.size(); ++c) {
    bool is_meshed = false;
    for_each_around(tissue, corners.corner[c], [&](const glm::ivec3& v) {
      is_meshed |= moving.meshed[tissue.brick_at(v)][v.z & 7] >> ((v.x & 7) + 8 * (v.y & 7)) & 1;
    });
    if (!is_meshed) continue;
    const glm::dvec3 at = glm::dvec3(corners.corner[c]) - 0.5;
    points.push_back({at, at});
    in_mesh_.push_back(c);
    index_.emplace(place_of(corners.corner[c], volume.grid), c);
  }
  points_ = std::make_unique<CarriedPoints>(mesh_, volume.grid, points, furthest_mm);
}

// Sets the posed corners of voxels that stick out of the mesh. Where another part of the mesh is near, these voxels are
// pressed flat there (posed_tets.h).
void CarriedCorners::press_riders(const Eigen::MatrixX3d& V, const std::vector<RigidTransform>& motions,
                                  std::vector<glm::dvec3>& posed) const {
  const PosedLattice lattice(volume_, tissue_, weights_, motions, Blend::Linear, glm::dvec3(1));
  const PosedTets tets(*mesh_, V, lattice, moving_.meshed);
  const AffineTransform to_world = world_from_voxel(volume_.grid);
  for (const PosedTets::Rider& rider : tets.riders())
    for (int i = 0; i < 8; ++i) {
      const glm::ivec3 corner = rider.voxel + glm::ivec3(i & 1, i >> 1 & 1, i >> 2);
      const auto at = index_.find(place_of(corner, volume_.grid));
      if (at == index_.end()) continue;
      const glm::dvec3 there = glm::dvec3(rider.corners[i]) / double(kFixedOne);
      posed[at->second] = to_world * lattice.output().to_rest(there);
    }
}

std::vector<glm::dvec3> CarriedCorners::posed(const Eigen::MatrixX3d& V,
                                              const std::vector<RigidTransform>& motions) const {
  std::vector<glm::dvec3> posed(corners_.size());
  parallel_for(corners_.size(), 4096, [&](std::int64_t begin, std::int64_t end) {
    for (auto c = begin; c < end; ++c) {
      // The weights of bones with the same motion are added up.
      int most = -1;
      double largest = 0;
      for (auto i = corners_.offsets[c]; i < corners_.offsets[c + 1]; ++i) {
        const RigidTransform& motion = motions[corners_.influences[i].bone];
        double weight = 0;
        for (auto k = corners_.offsets[c]; k < corners_.offsets[c + 1]; ++k) {
          const RigidTransform& other = motions[corners_.influences[k].bone];
          if (other.rotation == motion.rotation && other.translation == motion.translation)
            weight += corners_.influences[k].weight;
        }
        if (weight > largest) largest = weight, most = corners_.influences[i].bone;
      }
      posed[c] = most < 0 ? corners_.rest[c] : motions[most] * corners_.rest[c];
    }
  });
  const auto carried = points_->posed(V);
  for (std::size_t i = 0; i < carried.size(); ++i)
    if (carried[i]) posed[in_mesh_[i]] = world_from_voxel(volume_.grid) * *carried[i];
  press_riders(V, motions, posed);
  return posed;
}

}  // namespace limber
