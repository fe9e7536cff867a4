// SPDX-License-Identifier: AGPL-3.0-or-later
// The option --seams FILE|none. Seams are the voxel faces where tissue touches without being connected.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "core/body/bind_body.h"

namespace limber::cmd {

// Adds the option --seams. `seams` must live as long as the command.
void add_seam_option(CLI::App& command, std::string& seams);

// Reads the seams file that --seams names. Without the option (""), the seams are those of the given weights, or they
// are found automatically.
SeamChoice read_seam_choice(const std::string& seams, const LabelVolume& volume, Progress& progress);

}  // namespace limber::cmd
