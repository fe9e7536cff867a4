// SPDX-License-Identifier: AGPL-3.0-or-later
// The corners of the voxels around a joint (lattice.h), and their positions when posed by blending and by a solved
// mesh.
#pragma once

#include <memory>
#include <unordered_map>
#include <vector>

#include "core/deform/carried_points.h"
#include "core/deform/skinning.h"
#include "core/fem/deforming_region.h"
#include "core/skin/skin_weights.h"

namespace limber {

struct JointCorners {
  std::vector<glm::ivec3> corner;  // #C corners, each given by the voxel of which it is the lowest; by brick, x fastest
  std::vector<glm::dvec3> rest;    // #C positions at rest, world, mm
  std::vector<std::int64_t> offsets;   // #C + 1: index of the first influence of each corner
  std::vector<BoneWeight> influences;  // weights of all corners, one corner after another, ascending by bone
  std::vector<std::uint8_t> is_soft;   // #C: whether a voxel of soft tissue is around the corner
  std::vector<std::uint8_t> is_skin;   // #C: whether a voxel of skin is around the corner
  std::int64_t size() const { return std::ssize(corner); }
};

// Returns the corners of all tissue that blending bends in one of the poses, or that a mesh carries, and those of the
// neighbouring bricks of voxels.
//   weights   in bone tissue, each voxel follows one bone
//   motions   of the bones of `weights` in each pose
//   meshed    tissue that a mesh carries, one mask for each mesh
JointCorners joint_corners(const LabelVolume& volume, const TissueVoxels& tissue, const SkinWeights& weights,
                           const LabelSet& is_bone, const LabelSet& is_skin,
                           const std::vector<std::vector<RigidTransform>>& motions,
                           const std::vector<const TissueMask*>& meshed);

// Returns where blending by dual quaternions poses the corners, world, mm.
std::vector<glm::dvec3> blended_corners(const JointCorners& corners, const std::vector<RigidTransform>& motions);

// The positions to which a solved mesh carries the corners.
class CarriedCorners {
 public:
  // Keeps references to all arguments, which must outlive this object.
  //   weights      in bone tissue, each voxel follows one bone
  //   moving       the tissue that the mesh carries
  //   furthest_mm  corners of this tissue that are further outside the mesh than this follow a bone
  CarriedCorners(const JointCorners& corners, const LabelVolume& volume, const TissueVoxels& tissue,
                 const SkinWeights& weights, const DeformingRegion& moving, std::shared_ptr<const TetMesh> mesh,
                 double furthest_mm);

  // Returns the posed corners, world, mm. Corners of tissue in the mesh move with the mesh, and those just outside are
  // pressed flat where another part of the mesh is near, as in posed_tets.h. Corners in bone move with the mesh too, so
  // that the cells of bone and of the flesh around it stay neighbours; the bone itself is painted by its rigid motion.
  // All other corners follow the bone whose motion has most of their weight.
  //   V        #V by 3 posed nodes, world, mm
  //   motions  of the bones of the weights in this pose
  std::vector<glm::dvec3> posed(const Eigen::MatrixX3d& V, const std::vector<RigidTransform>& motions) const;

 private:
  void press_riders(const Eigen::MatrixX3d& V, const std::vector<RigidTransform>& motions,
                    std::vector<glm::dvec3>& posed) const;

  const JointCorners& corners_;
  const LabelVolume& volume_;
  const TissueVoxels& tissue_;
  SkinWeights weights_;  // in tissue that does not deform, each voxel follows one bone
  const DeformingRegion& moving_;
  std::shared_ptr<const TetMesh> mesh_;
  // For each corner that the mesh carries, by its index among the volume's corners: its index in corners_.
  std::unordered_map<std::int64_t, std::int64_t> index_;
  std::vector<std::int64_t> in_mesh_;  // indices in corners_ of the corners that the mesh carries
  std::unique_ptr<CarriedPoints> points_;
};

}  // namespace limber
