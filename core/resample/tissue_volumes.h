// SPDX-License-Identifier: AGPL-3.0-or-later
// Gives soft tissues the volumes they should have by moving the borders between them, voxel by voxel: the fewest, and
// those that are least sure of their tissue. Reading labels on a turned grid takes voxels from layers and cords of one
// voxel; and blending loses tissue where a joint folds. Bones are never touched.
//
// Tissues with too many voxels and such with too few are the sources and sinks of a flow whose edges are the borders
// between tissues; each unit of it is one voxel that changes hands, the next cheapest path first (successive shortest
// paths, as in [Ahuja, Magnanti & Orlin, Network Flows, 1993, 9.7], without taking back). Air has any number of voxels:
// a body that is too small grows, one that is too large shrinks, and its skin keeps its thickness: what lies under it
// grows, and skin moves up.
//
// No part of a tissue (26-connected) is torn, joined to another, made or lost, no air is enclosed, and no skin opened.
// Parts of about 50 voxels keep their size, so that as many count as before (metrics.h).
#pragma once

#include <map>
#include <vector>

#include "core/resample/neighbourhood.h"

namespace limber {

// A voxel that may change hands.
struct BorderMove {
  std::int64_t at;  // of the posed volume
  Label from, to;   // soft tissues, or air
  float cost;       // how much surer it is of its own tissue, a difference of memberships [0, 1]
};

struct TissueVolumes {
  std::int64_t changed = 0;               // voxels
  std::map<Label, std::int64_t> missing;  // wanted less what there is, of tissues that did not get what was wanted
};

//   posed   voxels of soft tissue change; voxels of air too where all that is wanted is not as much as there is
//   wanted  voxels of each soft tissue; one that is not named keeps what it has
//   moves   between soft tissues, and of soft tissue to air; those of air are found here
TissueVolumes keep_tissue_volumes(LabelVolume& posed, const std::map<Label, std::int64_t>& wanted,
                                  const std::vector<BorderMove>& moves, const LabelSet& soft, const LabelSet& skin);

}  // namespace limber
