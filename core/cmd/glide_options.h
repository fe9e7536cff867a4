// SPDX-License-Identifier: AGPL-3.0-or-later
// How a command is told whether joints glide, so that bones do not enter each other: [--glide off|voxel|joint|MM].
//   joint  each joint by up to 5 percent of its shorter bone
//   voxel  the same, but no bone further than a voxel's longest edge from where the pose puts it, by all shifts above
//   it
//          together
//   MM     each joint by up to that
// Poses by the names of joints and by hinges say at which angles joints stand: there it is `joint` where nothing is
// said. A pose file and a motion say where the bones of this rig stand, and what was looked at before, in the
// editor's live view or with feet on the floor, shall come out: there it is `voxel`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/cmd/body_options.h"
#include "core/cmd/pose_options.h"
#include "core/resample/glide_joints.h"

namespace limber::cmd {

// `glide` must live as long as the command.
void add_glide_option(CLI::App& command, std::string& glide);

// None where joints stay as the rig has them. Throws Error for what is neither such a word nor a length.
//   voxel  mm, its longest edge
std::optional<GlideSettings> glide_settings(const std::string& glide, const PoseOptions& pose, double voxel);

// What is taken: off, voxel, joint, or the length that was given.
std::string glide_word(const std::string& glide, const PoseOptions& pose);

// Shifts joints of each pose; returns which, by pose. Makes the weights rigid in bone tissue, as resampling does.
std::vector<std::vector<GlidedJoint>> glide_poses(std::vector<Pose>& poses, const GlideSettings& settings,
                                                  const Body& body, const TissueVoxels& tissue, SkinWeights& weights,
                                                  Progress& progress);

// How many voxels two bones claim, and which joints are not free. Empty where neither is to be told.
//   joints  none where joints do not glide
std::string overlap_warning(const std::optional<std::vector<GlidedJoint>>& joints, std::int64_t claimed_twice);

}  // namespace limber::cmd
