// SPDX-License-Identifier: AGPL-3.0-or-later
// The option --glide off|voxel|joint|MM: how far joints may glide (translate) so that bones do not enter each other
// (core/body/glide_poses.h). The default depends on the pose options. Joint angles alone (--joint, --flex, --pose-name)
// do not determine the positions of bones, so the default is `joint`. A pose file or a motion gives the positions of
// this rig's bones, and the result should match what the user saw before, such as the editor's live view or feet on the
// floor; so the default is `voxel`.
#pragma once

#include <string>

#include "core/cmd/pose_options.h"

namespace limber::cmd {

// Adds the option --glide. `glide` must live as long as the command.
void add_glide_option(CLI::App& command, std::string& glide);

// Returns the effective value of --glide: off, voxel, joint or a length. If --glide was not given (""), it depends on
// the pose options.
std::string glide_word(const std::string& glide, const PoseOptions& pose);

}  // namespace limber::cmd
