// SPDX-License-Identifier: AGPL-3.0-or-later
// Judges a pose by the bones of the body instead of by the program's own bone parts: each label that names a bone, on
// each side, is one rigid thing that must follow the rig bone it belongs to. A part that went with another rig bone is
// rigid too, so a residual measured against parts cannot see it; this can.
#pragma once

#include <string>
#include <vector>

#include "core/base/rigid_transform.h"
#include "core/bones/bone_identity.h"
#include "core/skin/skin_weights.h"

namespace limber {

struct WholeBone {
  Label label = 0;
  double file_value = 0;  // of the label, as files have it
  std::string name;
  std::string
      belongs_to;  // rig bone; where several may carry it, the one that most of its voxels follow, else the first
  std::string went_with;  // the rig bone that most of the wrong voxels follow; empty where there are none
  std::int64_t voxels = 0;
  std::int64_t wrong_voxels = 0;  // that follow a rig bone which the label's name or the map does not allow
  double residual_mm =
      0;  // largest distance from the best rigid motion of all its voxels; 0 for labels of several bones
};

// By label, then side; labels that name no bone are left out.
//   posed_from_rest  #bones of `weights`
std::vector<WholeBone> whole_bones(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                                   const Armature& armature, const SkinWeights& weights,
                                   const std::vector<RigidTransform>& posed_from_rest, const BoneMap& map = {});

// One sentence for each bone of which more than a thousandth went astray, worst first, at most `most` and one that
// counts the others.
std::vector<std::string> astray_bones(const std::vector<WholeBone>& bones, std::size_t most = 5);

// The rigid motion that carries `rest` to `posed` with the least squares of distances [Kabsch 1976].
//   rest, posed  #points, mm
RigidTransform best_rigid_motion(const std::vector<glm::dvec3>& rest, const std::vector<glm::dvec3>& posed);

}  // namespace limber
