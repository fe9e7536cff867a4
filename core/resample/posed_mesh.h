// SPDX-License-Identifier: AGPL-3.0-or-later
// Moves the tet mesh of a whole body to a pose, so that rest and pose have the same tets. The nodes of a bone move
// rigidly with it. All other nodes move as the tissue around them (posed_points.h); a node on a seam moves as the
// tissue on its own side of the seam. Flesh next to bone is shifted so that it stays attached to the bone. Where a
// joint is bent so far that tets turn inside out, nodes of soft tissue are moved to turn them back.
#pragma once

#include <cstdint>
#include <memory>

#include "core/mesh/body_mesh.h"
#include "core/resample/posed_points.h"

namespace limber {

struct PosedMesh {
  Eigen::MatrixX3d V;           // positions of the mesh's nodes in the pose, world, mm
  std::int64_t inside_out = 0;  // number of tets that are inside out
};

// Returns the seams along which the mesh of a body that is to be posed is cut: the seams of the tissue and, in joints,
// the surface of each bone near another bone of the rig. Because of the cuts in joints, no node belongs to two bones.
std::shared_ptr<const Seams> seams_and_joints(const LabelVolume& volume, const TissueVoxels& tissue,
                                              const TissueTable& tissues, const SkinWeights& weights);

// Returns the posed positions of the nodes of `body`. The other arguments are those of posed_points().
PosedMesh pose_mesh(const BodyMesh& body, const LabelVolume& volume, const TissueVoxels& tissue,
                    const TissueTable& tissues, const SkinWeights& weights, const Armature& armature, const Pose& pose,
                    Blend blend, const FemShape* shape, const BakedJoints& baked = {});

}  // namespace limber
