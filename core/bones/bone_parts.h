// SPDX-License-Identifier: AGPL-3.0-or-later
// Separates the bone tissue of a volume into bones. All bones of a limb are often one connected blob of one label,
// because joints are thinner than a voxel. First, bones that touch in a joint or side by side are cut apart
// (core/bones/joint_cuts.h). Then a watershed splits the blob; it grows from the marrow cores or, without marrow, from
// the deepest points of the bone. Each part follows the rig bone that it surrounds. Bender's weight files
// (skin/weights_io.h) separate bones by planes. These planes are not used here: on Bender's sample arm they would give
// 1004 voxels to the wrong bone.
//
// A label whose name says which bone it is has precedence over shape (core/bones/bone_identity.h). A label of several
// bones ("Wrists and hand bones") is split by shape among the rig bones that its name allows.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/bones/bone_identity.h"
#include "core/bones/joint_cuts.h"
#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

struct BoneParts {
  struct Part {
    int bone;  // index of the rig bone in the armature
    std::int64_t voxel_count;
    glm::dvec3 centre;  // centre of the part's voxels; world, mm
  };
  std::vector<Part> parts;
  ZeroedVector<std::uint16_t> part_of;  // for each tissue voxel: 1 + index in `parts`; 0: not bone

  // A rig bone that voxels of a label follow, and how this assignment was found.
  struct Identity {
    Label label;
    int bone;
    FoundBy found_by;
    bool is_substitute;  // true: the rig has no bone that matches the label's name
    std::int64_t voxel_count;
  };
  std::vector<Identity> identities;  // all pairs of a label and a rig bone, sorted by label, then bone

  // Pairs of bones that touch so broadly that the cut between them is uncertain.
  std::vector<BroadCut> broad_cuts;
};

BoneParts split_bones(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                      const Armature& armature, Progress& progress = no_progress(), const BoneMap& map = {});

}  // namespace limber
