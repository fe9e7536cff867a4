// SPDX-License-Identifier: AGPL-3.0-or-later
// Judges a pose by the bones of the body instead of by the program's own split of bone tissue into parts. The voxels of
// a label that names a bone, on one side of the body, are one rigid bone that must follow the rig bone it belongs to. A
// part that follows a wrong rig bone still moves rigidly, so a residual measured for each part cannot detect this
// fault. This measure can.
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
  std::string belongs_to;  // of the rig bones that the label allows, the one that most voxels follow, else the first
  std::string went_with;   // the rig bone that most of the wrong voxels follow; empty: no voxel is wrong
  std::int64_t voxels = 0;
  std::int64_t wrong_voxels = 0;  // voxels that follow a rig bone that neither the label's name nor the map allows
  double residual_mm = 0;         // largest distance from the best rigid motion; 0 for labels of several bones
};

// Returns the bones sorted by label, then side. Labels that name no bone are left out.
//   posed_from_rest  transform of each bone of `weights` from rest to posed
std::vector<WholeBone> whole_bones(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                                   const Armature& armature, const SkinWeights& weights,
                                   const std::vector<RigidTransform>& posed_from_rest, const BoneMap& map = {});

// Returns one sentence for each bone of which more than a thousandth of the voxels are wrong, the worst first. Returns
// at most `most` such sentences, and one more that counts the other bones.
std::vector<std::string> astray_bones(const std::vector<WholeBone>& bones, std::size_t most = 5);

// Returns the rigid motion that takes `rest` to `posed` with the least sum of squared distances [Kabsch 1976].
//   rest, posed  #points, mm
RigidTransform best_rigid_motion(const std::vector<glm::dvec3>& rest, const std::vector<glm::dvec3>& posed);

}  // namespace limber
