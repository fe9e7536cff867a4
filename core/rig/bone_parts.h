// SPDX-License-Identifier: AGPL-3.0-or-later
// The bone tissue of a volume, separated into its bones. By label all bones of a limb are often one connected blob
// (joints are thinner than a voxel), so the blob is split by a watershed that grows from the marrow cores, or without
// marrow from the deepest points of the bone's distance map; each part goes to the rig bone it hugs. A bone is never
// cut by a plane of the skin map: that puts 1004 voxels of the paper's arm on the wrong bone.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/rig/armature.h"
#include "core/volume/tissue_table.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

struct BoneParts {
  struct Part {
    int bone;                   // of the armature
    std::int64_t voxel_count;
    glm::dvec3 centre;          // world, mm
  };
  std::vector<Part> parts;
  std::vector<std::uint16_t> part_of;  // #N tissue voxels: 0 = not bone, else 1 + place in `parts`
};

BoneParts split_bones(const LabelVolume& volume, const TissueVoxels& tissue, const TissueTable& tissues,
                      const Armature& armature, Progress& progress = no_progress());

}  // namespace limber
