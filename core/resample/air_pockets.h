// SPDX-License-Identifier: AGPL-3.0-or-later
// Air that a body encloses. A fold that closes over a hollow would leave a bubble where in a body flesh is pressed
// together, and a hollow that was there would grow with the flesh that is stretched around it: a body holds as much air
// as before.
#pragma once

#include <map>
#include <vector>

#include "core/resample/neighbourhood.h"
#include "core/volume/label_sampler.h"

namespace limber {

// The voxels of one hollow, none of which a way through faces of air joins to the border of the grid.
using AirPocket = std::vector<glm::ivec3>;
std::vector<AirPocket> air_pockets(const LabelVolume& volume);

// Pockets of `posed` get the size that the hollows behind their walls had at rest, none where there was none: what is
// more is filled, from the walls on, with the soft tissue nearest to it. Where skin lines the walls that is what lies
// under it, and what is left of the pocket is lined with skin again.
//   flesh  soft tissues but skin, by label      soft  with skin
//   returns  the voxels filled, each after those that it was filled from
std::vector<glm::ivec3> fill_grown_pockets(LabelVolume& posed, const LabelVolume& rest, const LabelSet& flesh,
                                           const LabelSet& soft, const RestPoint& rest_point);

// Where tissue comes from that fills what was air: from where the tissue beside it comes from.
struct Origin {
  std::int64_t beside;  // the voxel of the posed volume that it was taken from
  glm::dvec3 rest;
};
using Origins = std::map<std::int64_t, Origin>;  // by voxel of the posed volume
//   was_air     such voxels, each beside tissue that was there or an earlier one
//   rest_point  asked of tissue that was there
Origins origins_of(const LabelVolume& posed, const std::vector<glm::ivec3>& was_air, const RestPoint& rest_point);

}  // namespace limber
