// SPDX-License-Identifier: AGPL-3.0-or-later
// How far the joints of a body may glide (translate) so that bones do not enter each other. The limit is given as a
// word:
//   joint  each joint may shift by 5 percent of the shorter one of its two bones
//   voxel  as `joint`, but no bone may move further from its position in the pose than a voxel's longest edge. The
//          shifts of all joints above the bone count together.
//   MM     each joint may shift by up to this length
//   off    joints do not shift
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/body/body.h"
#include "core/resample/glide_joints.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

// Returns how far joints may glide; nothing if `word` is "off". Throws Error for a value that is neither one of the
// words nor a length.
//   voxel  a voxel's longest edge, mm        where  names the word's origin in the message, such as an option
std::optional<GlideSettings> glide_settings(const std::string& word, double voxel, const std::string& where);

// Shifts the joints of each pose so that bones do not enter each other, and returns the shifted joints of each pose.
// Also changes `weights`: afterwards every voxel of bone follows one rig bone alone (with_rigid_bones()).
std::vector<std::vector<GlidedJoint>> glide_poses(std::vector<Pose>& poses, const GlideSettings& settings,
                                                  const Body& body, const Armature& rig, const TissueVoxels& tissue,
                                                  SkinWeights& weights, Progress& progress);

// Returns a warning with the number of posed voxels that two bones fill, and the joints whose bones still overlap.
// Returns "" if there is neither.
//   joints  the shifted joints; empty where joints do not glide
std::string overlap_warning(const std::optional<std::vector<GlidedJoint>>& joints, std::int64_t claimed_twice);

}  // namespace limber
