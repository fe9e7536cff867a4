// SPDX-License-Identifier: AGPL-3.0-or-later
// The bone tissue of a volume, separated into its bones. By label all bones of a limb are often one connected blob
// (joints are thinner than a voxel), so the blob is split by a watershed that grows from the marrow cores, or without
// marrow from the deepest points of the bone's distance map; each part goes to the rig bone it hugs. Before, bones that
// touch in a joint or side by side are cut apart there (core/bones/joint_cuts.h). A bone is never cut by a plane of the
// skin map: that puts 1004 voxels of the paper's arm on the wrong bone.
//
// Where labels say which bone of the body they are, that counts before any shape (core/bones/bone_identity.h). A label
// of several bones ("Wrists and hand bones") is parted by its shape among the rig bones that its name allows.
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
    int bone;  // of the armature
    std::int64_t voxel_count;
    glm::dvec3 centre;  // world, mm
  };
  std::vector<Part> parts;
  std::vector<std::uint16_t> part_of;  // #N tissue voxels: 0 = not bone, else 1 + place in `parts`

  // Which rig bones each label of bone tissue follows, and how that was found.
  struct Identity {
    Label label;
    int bone;
    FoundBy found_by;
    bool is_substitute;  // the rig has no bone for what the label's name means
    std::int64_t voxel_count;
  };
  std::vector<Identity> identities;  // by label, then bone

  std::vector<BroadCut> broad_cuts;  // bones in one label that touch too broadly to say where one ends
};

BoneParts split_bones(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                      const Armature& armature, Progress& progress = no_progress(), const BoneMap& map = {});

}  // namespace limber
