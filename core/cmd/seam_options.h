// SPDX-License-Identifier: AGPL-3.0-or-later
// How a command is told where tissue touches without being one: [--seams FILE|none].
#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "core/bones/bone_parts.h"
#include "core/cmd/body_options.h"
#include "core/volume/tissue_voxels.h"

namespace limber::cmd {

// `seams` must live as long as the command.
void add_seam_option(CLI::App& command, std::string& seams);

// Into `tissue`: those of the file, none, or where nothing is said those that are found.
//   parts  asked only where seams are looked for
void set_seams(TissueVoxels& tissue, const std::string& seams, const Body& body,
               const std::function<const BoneParts&()>& parts, Progress& progress);

}  // namespace limber::cmd
