// SPDX-License-Identifier: AGPL-3.0-or-later
// The subcommand that needs something of the program around it: who draws bodies for its report.
#pragma once

#include <CLI/CLI.hpp>

#include "core/study/picture.h"

namespace limber::cmd {

//   pictures  none in a program without the renderer: the report says so
void add_experiment(CLI::App& app, const StartPictures& pictures = {});

}  // namespace limber::cmd
