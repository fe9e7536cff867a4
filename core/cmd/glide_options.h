// SPDX-License-Identifier: AGPL-3.0-or-later
// The option that says how far joints glide, so that bones do not enter each other: [--glide off|voxel|joint|MM].
//   joint  each joint may shift by 5 percent of its shorter bone
//   voxel  as joint, but a bone may be moved away from its place in the pose by a voxel's longest edge at most, all
//          shifts of the joints above it added together
//   MM     each joint may shift by up to this length
// The default depends on the pose options. Joint names and hinges only give the angles of joints, so the default is
// `joint`. A pose file and a motion say where the bones of this rig stand, and the result should match what the user
// saw before (in the editor's live view, or feet on the floor), so the default is `voxel`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/cmd/body_options.h"
#include "core/cmd/pose_options.h"
#include "core/resample/glide_joints.h"

namespace limber::cmd {

// Adds the option. `glide` must live as long as the command.
void add_glide_option(CLI::App& command, std::string& glide);

// Returns how far joints may glide, or nothing where they do not glide. Throws Error for a value that is neither one of
// the words nor a length.
//   voxel  a voxel's longest edge, mm
std::optional<GlideSettings> glide_settings(const std::string& glide, const PoseOptions& pose, double voxel);

// Returns the setting that is used, which depends on the pose without --glide: off, voxel, joint, or the given length.
std::string glide_word(const std::string& glide, const PoseOptions& pose);

// Shifts the joints of each pose so that bones do not enter each other, and returns the shifted joints of each pose.
// Makes the weights rigid in bone tissue, as resampling does.
std::vector<std::vector<GlidedJoint>> glide_poses(std::vector<Pose>& poses, const GlideSettings& settings,
                                                  const Body& body, const TissueVoxels& tissue, SkinWeights& weights,
                                                  Progress& progress);

// Returns a warning that tells how many voxels two bones claim and which joints still overlap. Returns "" without such
// voxels and joints.
//   joints  the shifted joints; empty where joints do not glide
std::string overlap_warning(const std::optional<std::vector<GlidedJoint>>& joints, std::int64_t claimed_twice);

}  // namespace limber::cmd
