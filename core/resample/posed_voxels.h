// SPDX-License-Identifier: AGPL-3.0-or-later
// From the inverse map of a posed body to its voxels: read tile by tile from the volume at rest, then mended where the
// grid or a stretch tore what was whole (preserve_connectivity.h, bone_volumes.h), and where it is asked for brought
// back to the volumes that tissues have (tissue_volumes.h).
#pragma once

#include <vector>

#include "core/base/progress.h"
#include "core/resample/output_grid.h"
#include "core/resample/resample.h"

namespace limber {

// By label.
struct LabelSets {
  LabelSet bone = LabelSet(65536, 0), soft = LabelSet(65536, 1), skin = LabelSet(65536, 0);
  std::vector<int> priority = std::vector<int>(65536, 0);

  explicit LabelSets(const TissueTable& tissues) {
    for (const Tissue& tissue : tissues.tissues) {
      priority[tissue.label] = tissue.priority;
      skin[tissue.label] = tissue.kind == TissueKind::Skin;
      if (!is_bone(tissue.kind)) continue;
      bone[tissue.label] = 1;
      soft[tissue.label] = 0;
    }
  }
};

struct PosedBody {
  const LabelVolume& volume;  // at rest
  const TissueTable& tissues;
  const LabelSets& labels;
  const PosedLattice& lattice;
  const RigidBones& bones;
  const PosedTets* tets;     // nullptr: not by finite elements
  const TissueDepth* depth;  // at rest, mm; nullptr where the body cannot fold
  const OutputGrid& output;
  bool mends;  // tears and lost volumes
};

// Into posed: its volume, the fields that are asked for, and what its report says of voxels.
// throws Error where a tissue would need more than settings.mass_limit_percent to keep its mass
void write_voxels(const PosedBody& body, const ResampleSettings& settings, Posed& posed, Progress& progress);

}  // namespace limber
