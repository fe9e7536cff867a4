// SPDX-License-Identifier: AGPL-3.0-or-later
// The option --seams FILE|none. Seams are the voxel faces where tissue touches without being connected.
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "core/bones/bone_parts.h"
#include "core/cmd/body_options.h"
#include "core/volume/tissue_voxels.h"

namespace limber::cmd {

// Adds the option --seams. `seams` must live as long as the command.
void add_seam_option(CLI::App& command, std::string& seams);

// Sets the seams of `tissue`: those of the file that --seams names, or none with "none". Without the option, seams are
// found automatically.
//   seams  the value of --seams; "": not given
//   parts  returns the bone parts of the body, which finding seams needs; called only for that, since it is slow
void set_seams(TissueVoxels& tissue, const std::string& seams, const Body& body,
               const std::function<const BoneParts&()>& parts, Progress& progress);

}  // namespace limber::cmd
