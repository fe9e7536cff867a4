// SPDX-License-Identifier: AGPL-3.0-or-later
// Bands and webs: soft tissue that a pose pulled out between two parts of the body that are no neighbours, such as a
// hand that had grown to the hip. Measured from the displacement alone: the gradient of the map from posed to rest,
// taken between neighbouring voxels that were neighbours at rest, has a smallest singular value; its inverse is the
// largest stretch there.
//
// Tissue around a turned joint is stretched as well, and has to be. It is left out where it lies within the joint's
// reach, some times the depth of the joint below the skin, and where it went no further than that joint could have
// carried it: near the arc between what the joint's two bones do to it. What spans other bones is a band, however near
// a joint it lay at rest.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/report/exposure.h"
#include "core/report/judged_pose.h"

namespace limber {

struct BandLimits {
  double stretch = 2;              // times its length at rest
  double joint_reach = 5;          // times the joint's depth below the outside air
  double off_arc = 0.25;           // of that reach
  std::int64_t least_voxels = 50;  // of one band: fewer are what rounding does
};

struct Band {
  std::int64_t voxels = 0;
  double mm3 = 0;
  double stretch = 0;                  // median of its voxels
  glm::dvec3 place{0};                 // a voxel in its middle, world, mm
  std::array<std::string, 2> between;  // rig bones; empty where its ends cannot be told
};

// Largest first. Needs the displacement and the rig.
std::vector<Band> find_bands(const JudgedPose& pose, const AirAround& air, const BandLimits& limits = {});

// The largest stretch of a map given by its gradient, rest from posed: 1 / its smallest singular value; infinity where
// it folds flat.
double largest_stretch(const glm::dmat3& rest_from_posed);

}  // namespace limber
