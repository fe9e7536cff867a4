// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds and fills the air that a posed body encloses. A fold that closes over a hollow would leave a bubble where in a
// real body flesh is pressed together, and a hollow that exists at rest would grow with the flesh that is stretched
// around it. So every air pocket is filled until it has the volume that it has at rest.
#pragma once

#include <map>
#include <vector>

#include "core/resample/neighbourhood.h"
#include "core/volume/label_sampler.h"

namespace limber {

// The voxels of one hollow: connected air that no path through voxel faces joins to the border of the grid.
using AirPocket = std::vector<glm::ivec3>;
std::vector<AirPocket> air_pockets(const LabelVolume& volume);

// Shrinks every air pocket of `posed` to the volume of the hollow that its walls enclose at rest (0 where they enclose
// none). The surplus is filled from the walls inwards with the nearest soft tissue. Where skin lines the walls, the
// tissue under the skin fills the pocket, and what is left of the pocket is lined with skin again.
//   flesh  soft tissues without skin, by label      soft  soft tissues with skin, by label
//   returns  the filled voxels, each one after the voxels that it was filled from
std::vector<glm::ivec3> fill_grown_pockets(LabelVolume& posed, const LabelVolume& rest, const LabelSet& flesh,
                                           const LabelSet& soft, const RestPoint& rest_point);

// The rest point given to a voxel that was air and is filled with tissue now: the rest point of the tissue beside it.
struct Origin {
  std::int64_t beside;  // index of the neighbouring posed voxel that the rest point is taken from
  glm::dvec3 rest;      // voxel coordinates
};
using Origins = std::map<std::int64_t, Origin>;  // by index of the filled voxel in the posed volume
// Returns for every filled voxel its rest point, and the neighbour that the rest point is taken from.
//   was_air     filled voxels, each one beside original tissue or beside an earlier voxel of the list
//   rest_point  called for voxels of original tissue only
Origins origins_of(const LabelVolume& posed, const std::vector<glm::ivec3>& was_air, const RestPoint& rest_point);

}  // namespace limber
