// SPDX-License-Identifier: AGPL-3.0-or-later
// The subcommand `experiment`. It is not in command.h because its caller passes the function that draws bodies for the
// report.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "core/study/picture.h"

namespace limber::cmd {

// Adds the subcommand `experiment`.
//   commit    the commit that the program was built from (program_commit.h); "": unknown
//   pictures  returns an object that draws bodies in 3D for the report. Empty in a program without the renderer; the
//             report then says that it has no pictures.
void add_experiment(CLI::App& app, const std::string& commit, const StartPictures& pictures = {});

}  // namespace limber::cmd
