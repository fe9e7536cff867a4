// SPDX-License-Identifier: AGPL-3.0-or-later
// The option that names seams, the voxel faces where tissue touches without being connected: [--seams FILE|none].
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "core/bones/bone_parts.h"
#include "core/cmd/body_options.h"
#include "core/volume/tissue_voxels.h"

namespace limber::cmd {

// Adds the option. `seams` must live as long as the command.
void add_seam_option(CLI::App& command, std::string& seams);

// Sets the seams of `tissue` as the option --seams says: the seams of its file, or none. Without the option they are
// found automatically.
//   parts  splits the bones; called only when seams must be found
void set_seams(TissueVoxels& tissue, const std::string& seams, const Body& body,
               const std::function<const BoneParts&()>& parts, Progress& progress);

}  // namespace limber::cmd
