// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes the voxels of a posed body. Its inverse map, which gives each posed voxel its position at rest, is computed
// tile by tile, and labels are read from the rest volume there. Then labels are repaired where rotation on the grid or
// stretch tears connected tissue or changes the volumes of bones (preserve_connectivity.h, bone_volumes.h). On request,
// soft tissues get their rest volumes (tissue_volumes.h).
#pragma once

#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/resample/output_grid.h"
#include "core/resample/resample.h"
#include "core/volume/tiled_labels.h"

namespace limber {

// Properties of the tissues, by label.
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

// The input of write_voxels(): a body and its deformation.
struct PosedBody {
  const LabelVolume& volume;  // the body's labels at rest
  const TissueTable& tissues;
  const LabelSets& labels;
  const PosedLattice& lattice;
  const RigidBones& bones;
  const PosedTets* tets;     // nullptr: posed without finite elements
  const TissueDepth* depth;  // depth below air at rest, mm; nullptr: no regions of the body can overlap
  const OutputGrid& output;
  bool mends;        // true: repairs tears and lost volumes
  bool keeps_flesh;  // true: the deformation keeps the volume of soft tissue, so each gets the voxels that come from it
};

// Fills the fields of `posed` that the settings ask for, and the voxel counts of its report. Returns the posed labels
// in tiles, so that the caller can free the deformation before the labels are laid out in rows (in_rows). If volumes of
// soft tissue had to be corrected, the labels are already in posed.volume, and nothing is returned. Throws Error if a
// tissue would have to change by more than settings.mass_limit_percent to keep its mass.
std::optional<TiledLabels> write_voxels(const PosedBody& body, const ResampleSettings& settings, Posed& posed,
                                        Progress& progress);

}  // namespace limber
