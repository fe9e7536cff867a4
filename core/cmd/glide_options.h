// SPDX-License-Identifier: AGPL-3.0-or-later
// The option --glide off|voxel|joint|MM: how far joints may glide (shift) so that bones do not enter each other.
//   joint  each joint may shift by 5 percent of the shorter one of its two bones
//   voxel  as `joint`, but no bone may move further from its position in the pose than a voxel's longest edge. The
//          shifts of all joints above the bone count together.
//   MM     each joint may shift by up to this length
// The default depends on the pose options. Options that give only the angles of joints (--joint, --flex, --pose-name)
// leave the positions of bones open, so the default is `joint`. A pose file or a motion gives the positions of this
// rig's bones, and the result should match what the user saw before (in the editor's live view, or feet on the floor),
// so the default is `voxel`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/cmd/body_options.h"
#include "core/cmd/pose_options.h"
#include "core/resample/glide_joints.h"

namespace limber::cmd {

// Adds the option --glide. `glide` must live as long as the command.
void add_glide_option(CLI::App& command, std::string& glide);

// Returns how far joints may glide; nothing if `glide` is "off". Throws Error for a value that is neither one of the
// words nor a length.
//   voxel  a voxel's longest edge, mm
std::optional<GlideSettings> glide_settings(const std::string& glide, const PoseOptions& pose, double voxel);

// Returns the value of --glide that applies: off, voxel, joint or a length. If --glide was not given (""), it depends
// on the pose options.
std::string glide_word(const std::string& glide, const PoseOptions& pose);

// Shifts the joints of each pose so that bones do not enter each other, and returns the shifted joints of each pose.
// Also changes `weights` so that bone tissue moves rigidly, as resampling does.
std::vector<std::vector<GlidedJoint>> glide_poses(std::vector<Pose>& poses, const GlideSettings& settings,
                                                  const Body& body, const TissueVoxels& tissue, SkinWeights& weights,
                                                  Progress& progress);

// Returns a warning with the number of voxels that two bones claim, and the joints whose bones still overlap. Returns
// "" if there is neither.
//   joints  the shifted joints; empty where joints do not glide
std::string overlap_warning(const std::optional<std::vector<GlidedJoint>>& joints, std::int64_t claimed_twice);

}  // namespace limber::cmd
