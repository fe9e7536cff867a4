// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds bands and webs: soft tissue that a pose pulls out between two parts of the body that should be separate, for
// example between a hand and the hip that it touches at rest. The measure needs only the displacement of each voxel. It
// computes the gradient of the map from posed to rest positions, by differences between posed neighbours that were
// neighbours at rest too. The inverse of the gradient's smallest singular value is the largest stretch at the voxel.
//
// Tissue around a turned joint must stretch, so it does not count as a band. Such tissue is recognised by two
// conditions: at rest it is within the joint's reach (a multiple of the joint's depth below the skin), and its posed
// position is close to the arc along which the joint's turn moves it. Stretched tissue between other bones is a band,
// however near to a joint it is at rest.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/report/exposure.h"
#include "core/report/judged_pose.h"

namespace limber {

struct BandLimits {
  double stretch = 2;      // least stretch of a band, as a multiple of the length at rest
  double joint_reach = 5;  // a joint's reach, within which tissue may stretch, as a multiple of the joint's depth
  // Stretched tissue counts as a band if its distance from a joint's arc is more than this fraction of the joint's
  // reach.
  double off_arc = 0.25;
  std::int64_t least_voxels = 50;  // size of the smallest band, in voxels: smaller ones may be due to rounding
};

struct Band {
  std::int64_t voxels = 0;
  double mm3 = 0;
  double stretch = 0;                  // median stretch of the band's voxels, as a multiple of the length at rest
  glm::dvec3 place{0};                 // a voxel in the middle of the band, world, mm
  std::array<std::string, 2> between;  // names of the rig bones that the band joins; empty where unknown
};

// Returns the bands, the largest first. `pose` must have the displacement and the rig.
std::vector<Band> find_bands(const JudgedPose& pose, const AirAround& air, const BandLimits& limits = {});

// Returns the largest stretch of the map from rest to posed positions, from the gradient of the inverse map: the
// inverse of the gradient's smallest singular value; infinity if this value is 0.
double largest_stretch(const glm::dmat3& rest_from_posed);

}  // namespace limber
