// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds and fills the air that a posed body encloses. A fold that closes would leave an air bubble where a real body
// presses flesh together. A hollow that exists at rest would grow where the flesh around it is stretched. So tissue
// fills every air pocket until the pocket has its volume at rest.
#pragma once

#include <map>
#include <vector>

#include "core/resample/neighbourhood.h"
#include "core/volume/label_sampler.h"

namespace limber {

// The voxels of one hollow: connected air that no path through voxel faces joins to the border of the grid.
using AirPocket = std::vector<glm::ivec3>;
std::vector<AirPocket> air_pockets(const LabelView& volume);

struct PocketsOfBoth {
  const std::vector<AirPocket>&posed, &rest;
};

// Shrinks every air pocket of `posed` to the volume of the hollow that the pocket's walls enclose at rest (0 if they
// enclose none). Soft tissue fills the pocket from the walls inwards. If skin lines the walls, the tissue under the
// skin fills the pocket, and the remaining air is lined with skin again.
//   pockets  the air pockets of `posed` and of `rest`
//   flesh    soft tissues without skin, by label      soft  soft tissues with skin, by label
//   returns  the filled voxels, layer by layer from the walls inwards
std::vector<glm::ivec3> fill_grown_pockets(LabelEdit posed, const LabelView& rest, const PocketsOfBoth& pockets,
                                           const LabelSet& flesh, const LabelSet& soft, const RestPoint& rest_point);

// The rest point (position at rest) of a voxel that was air and is now filled with tissue. No tissue was moved there,
// so it is the rest point of a neighbouring tissue voxel.
struct Origin {
  std::int64_t beside;  // index of the neighbouring posed voxel that the rest point is taken from
  glm::dvec3 rest;      // the rest point, voxel coordinates
};
using Origins = std::map<std::int64_t, Origin>;  // key: index of the filled voxel in the posed volume
// Returns, for each voxel that was filled with tissue, its rest point and the neighbour that it is taken from.
//   was_air     filled voxels, each one beside original tissue or beside an earlier voxel of the list
//   rest_point  called for voxels of original tissue only
Origins origins_of(const LabelView& posed, const std::vector<glm::ivec3>& was_air, const RestPoint& rest_point);

}  // namespace limber
