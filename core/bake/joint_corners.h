// SPDX-License-Identifier: AGPL-3.0-or-later
// The corners of the voxels around a joint (lattice.h): where blending poses them, and where a solved mesh does.
#pragma once

#include <memory>
#include <vector>

#include "core/deform/carried_points.h"
#include "core/deform/skinning.h"
#include "core/fem/deforming_region.h"
#include "core/skin/skin_weights.h"

namespace limber {

struct JointCorners {
  std::vector<glm::ivec3> corner;      // #C: the voxel whose lowest corner each is, by brick, x fastest
  std::vector<glm::dvec3> rest;        // #C positions at rest, world, mm
  std::vector<std::int64_t> offsets;   // #C + 1: where the influences of each corner begin
  std::vector<BoneWeight> influences;  // ascending by bone
  std::vector<std::uint8_t> is_soft;   // #C: whether a voxel of soft tissue is around the corner
  std::vector<std::uint8_t> is_skin;   // #C: whether a voxel of skin is
  std::int64_t size() const { return std::ssize(corner); }
};

// Returns the corners of all tissue that blending bends in one of the poses, or that a mesh carries, and of the bricks
// around it.
//   weights   rigid in bone tissue
//   motions   of the bones of `weights` in each pose
//   meshed    tissue that a mesh carries, one mask for each mesh
JointCorners joint_corners(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                           const LabelSet& is_bone, const LabelSet& is_skin,
                           const std::vector<std::vector<RigidTransform>>& motions,
                           const std::vector<const TissueMask*>& meshed);

// Returns where blending by dual quaternions poses the corners, world, mm.
std::vector<glm::dvec3> blended_corners(const JointCorners& corners, const std::vector<RigidTransform>& motions);

// The corners as a mesh carries them.
class CarriedCorners {
 public:
  // Keeps a reference to `corners`, which must outlive this object.
  //   meshed       tissue that the mesh carries
  //   furthest_mm  corners of this tissue that are further outside the mesh follow a bone
  CarriedCorners(const JointCorners& corners, const TissueVoxels& tissue, const Grid& grid, const TissueMask& meshed,
                 std::shared_ptr<const TetMesh> mesh, double furthest_mm);

  // Returns the posed corners, world, mm. Corners of soft tissue in the mesh move with it. All others follow the bone
  // whose motion has most of their weight.
  //   V        #V by 3 posed nodes, world, mm
  //   motions  of the bones of the weights in this pose
  std::vector<glm::dvec3> posed(const Eigen::MatrixX3d& V, const std::vector<RigidTransform>& motions) const;

 private:
  const JointCorners& corners_;
  AffineTransform world_from_voxel_;
  std::vector<std::int64_t> in_mesh_;  // indices of the corners that the mesh carries
  std::unique_ptr<CarriedPoints> points_;
};

}  // namespace limber
