// SPDX-License-Identifier: AGPL-3.0-or-later
// Gives soft tissues their wanted volumes by moving the borders between them. Volumes are wrong because layers and
// cords that are one voxel thick become thinner when labels are read on a rotated grid, and because skinning loses
// tissue where a joint folds. As few voxels as possible are changed, first those whose tissue is least certain. Bones
// are never changed.
//
// Tissues with too many voxels are the sources of a flow, tissues with too few its sinks, and the borders between
// tissues its edges. Each unit of flow changes the label of one voxel, and the cheapest path comes first (successive
// shortest paths, as in [Ahuja, Magnanti & Orlin, Network Flows, 1993, 9.7], without undoing earlier paths). Air is a
// source or sink without limit: a body that is too small grows into air, and one that is too large shrinks. Skin keeps
// its thickness: when the tissue under the skin grows, the skin moves outwards.
//
// No connected component of a tissue (26-connected) is torn, joined to another, created or lost, no air is enclosed,
// and no skin is opened. Components smaller than 100 voxels keep their size, so that the number of components of 50
// voxels or more stays the same (metrics.h).
#pragma once

#include <map>
#include <vector>

#include "core/resample/neighbourhood.h"
#include "core/volume/label_sampler.h"

namespace limber {

// A possible move: a change of the label of one voxel at a border between tissues.
struct BorderMove {
  std::int64_t at;  // index of the voxel in the posed volume
  Label from, to;   // the voxel's label before and after the move: soft tissue or air (0)
  float cost;       // membership of `from` minus membership of `to`, [0, 1]
};

// Adds the moves that are possible at a voxel of soft tissue: to air or to the soft tissue of a face neighbour. The
// voxel's membership of its own tissue must exceed its membership of the new one by less than 0.8.
//   sampler  reads the memberships at the voxel's rest point
void add_moves(const LabelVolume& posed, const glm::ivec3& voxel, const LabelSampler& sampler, const glm::dvec3& rest,
               const LabelSet& soft, std::vector<BorderMove>& moves);

struct TissueVolumes {
  std::int64_t changed = 0;               // number of label changes that were made
  std::map<Label, std::int64_t> missing;  // wanted minus present voxels of each tissue where they differ
};

// Moves the borders of soft tissues until they have the wanted volumes.
//   posed   changed: labels of soft tissue and, if the wanted total differs from the present total, of air
//   wanted  number of voxels of each soft tissue; tissues without an entry keep their number
//   moves   possible moves between soft tissues and from soft tissue to air; moves from air are found here
TissueVolumes keep_tissue_volumes(LabelVolume& posed, const std::map<Label, std::int64_t>& wanted,
                                  const std::vector<BorderMove>& moves, const LabelSet& soft, const LabelSet& skin);

}  // namespace limber
