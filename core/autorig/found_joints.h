// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the joints of a fitted body: their positions, the evidence for each joint, and its estimated error. The error
// follows from how much the shape of the body differs from the fitted atlas, from whether landmarks of the body agree,
// and from the share of the surface that is close to the atlas.
#pragma once

#include <string>
#include <vector>

#include "core/autorig/auto_rig.h"
#include "core/autorig/fit_target.h"
#include "core/autorig/named_joints.h"

namespace limber {

struct FoundJoints {
  std::vector<glm::dvec3> places;
  std::vector<JointFit> how;
};

// Returns the joints of a fitted body. The more the body's shape differs from the atlas, the more weight the landmarks
// of the body itself get.
FoundJoints found_joints(const Fitted& fitted, const FitTarget& target);

// Replaces joints by those that were found between bones named by labels. The joints below a replaced joint move with
// it.
//   size  diagonal of the tissue's extent, mm
void take_named(FoundJoints& found, const Armature& rig, const std::vector<NamedJoint>& named, double size);

// Raises the errors of joints near and beyond the planes at which the body is cut off. Joints beyond a cut are placed
// by proportion alone, and a limb that is cut off looks too short. Adds a warning that names these joints.
void doubt_cut_limbs(const Fitted& fitted, const FitTarget& target, FoundJoints& found,
                     std::vector<std::string>& warnings);

// Returns a byte per bone: 1 for the bones of the largest connected part of the body that has enough skin left by cuts.
// A hand whose forearm is cut away does not belong to this part. The two legs of a body without hips count as
// connected, since they have the same parent.
std::vector<std::uint8_t> seen_bones(const Fitted& fitted, const FitTarget& target);

}  // namespace limber
