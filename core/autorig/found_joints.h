// SPDX-License-Identifier: AGPL-3.0-or-later
// Where the joints of a fitted body lie, how each was told and how far it may be off: by how much the body is of
// another shape than the one laid over it, by landmarks of its own that agree or do not, and by how much of the surface
// lies where it should.
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

// Where the body is of another shape than the one laid over it, its own landmarks say more.
FoundJoints found_joints(const Fitted& fitted, const FitTarget& target);

// What the names of bones say counts; what hangs from such a joint moves along.
//   size  mm, the diagonal of the tissue's extent
void take_named(FoundJoints& found, const Armature& rig, const std::vector<NamedJoint>& named, double size);

// What lies beyond a cut is laid on by proportion alone, and a limb that is cut off looks short.
void doubt_cut_limbs(const Fitted& fitted, const FitTarget& target, FoundJoints& found,
                     std::vector<std::string>& warnings);

// A byte per bone: those that are seen well enough, and from one to the next. Those beyond a cut are not, nor a hand
// whose forearm is cut away; but both legs of a body without hips are, since they hang from one bone.
std::vector<std::uint8_t> seen_bones(const Fitted& fitted, const FitTarget& target);

}  // namespace limber
