// SPDX-License-Identifier: AGPL-3.0-or-later
// The options that name the files of a body: VOLUME --rig RIG [--tissues T] [--bones L,L] [--bone-map FILE].
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/progress.h"
#include "core/body/body.h"

namespace limber::cmd {

struct BodyOptions {
  std::string volume, rig, tissues, bone_map;  // file names; empty: not given
  // Labels of bone, as values in the volume's file. Empty: the tissue table names them, or they are guessed.
  std::vector<double> bones;
};

// Adds these options to a command. `options` must live as long as the command.
void add_body_options(CLI::App& command, BodyOptions& options);

// Reads the files that the options name. Warnings about the files go to stderr.
Body read_body(const BodyOptions& options, Progress& progress);

}  // namespace limber::cmd
