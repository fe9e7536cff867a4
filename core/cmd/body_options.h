// SPDX-License-Identifier: AGPL-3.0-or-later
// The options that name a body: VOLUME --rig RIG [--tissues T] [--bones L,L] [--bone-map FILE].
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/base/progress.h"
#include "core/bones/bone_identity.h"
#include "core/rig/armature.h"
#include "core/volume_io/volume_io.h"

namespace limber::cmd {

struct BodyOptions {
  std::string volume, rig, tissues, bone_map;  // file names; empty: not given
  std::vector<double> bones;                   // bone labels as in the file; empty: from the tissue table, else guessed
};

struct Body {
  VolumeFile file;
  TissueTable tissues;
  Armature rig;
  BoneMap bone_map;                 // the rig bones that the user assigned to labels
  std::vector<std::string> doubts;  // reasons for which the files may not belong together (input_doubts.h)
};

// Adds the options. `options` must live as long as the command.
void add_body_options(CLI::App& command, BodyOptions& options);

// Reads the files that the options name. Warnings about the files go to stderr.
Body read_body(const BodyOptions& options, Progress& progress);

}  // namespace limber::cmd
