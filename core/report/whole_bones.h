// SPDX-License-Identifier: AGPL-3.0-or-later
// Judges a pose by the bones that labels name, not by the parts into which this program splits bone tissue. The voxels
// of a label that names a bone, on one side of the body, are one rigid bone, which must follow the rig bone that it
// belongs to. A part that follows a wrong rig bone still moves rigidly, so a test whether each part moves rigidly
// cannot detect this fault. The measures of this file can.
#pragma once

#include <string>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/bones/bone_identity.h"
#include "core/skin/skin_weights.h"

namespace limber {

struct WholeBone {
  Label label = 0;
  double file_value = 0;  // the value that stands for the label in files
  std::string name;
  // Of the rig bones that the label allows, the one that most voxels follow; the first if no voxel follows any of them.
  std::string belongs_to;
  std::string went_with;  // the rig bone that most of the wrong voxels follow; empty: no voxel is wrong
  std::int64_t voxels = 0;
  std::int64_t wrong_voxels = 0;  // voxels that follow a rig bone not allowed by the label's name or the map
  // Largest distance of a voxel from the best rigid motion, mm; 0 if the label names several bones.
  double residual_mm = 0;
};

// Uses the weights to judge each bone that a label names. Returns the bones sorted by label, then side of the body.
//   posed_from_rest  transform of each bone of `weights` from rest to posed
std::vector<WholeBone> whole_bones(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                                   const Armature& armature, const SkinWeights& weights,
                                   const std::vector<RigidTransform>& posed_from_rest, const BoneMap& map = {});

// Returns one sentence for each bone of which more than a thousandth of the voxels follow a wrong rig bone, the bone
// with most such voxels first. Beyond `most` sentences, one more gives the number of the other bones.
std::vector<std::string> astray_bones(const std::vector<WholeBone>& bones, std::size_t most = 5);

// Returns the rigid motion that moves the points `rest` to `posed` with the least sum of squared distances [Kabsch
// 1976].
//   rest, posed  #points, mm
RigidTransform best_rigid_motion(const std::vector<glm::dvec3>& rest, const std::vector<glm::dvec3>& posed);

}  // namespace limber
