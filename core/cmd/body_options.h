// SPDX-License-Identifier: AGPL-3.0-or-later
// How a command is told a body: VOLUME --rig RIG [--tissues T] [--bones L,L] [--bone-map FILE].
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
  std::string volume, rig, tissues, bone_map;  // files
  std::vector<double>
      bones;  // labels that are bone, as in the file; none: what the tissue table says, else a guess by the rig
};

struct Body {
  VolumeFile file;
  TissueTable tissues;
  Armature rig;
  BoneMap bone_map;                 // which rig bones labels follow, where the user says
  std::vector<std::string> doubts;  // of files that do not belong together [input_doubts.h]
};

// `options` must live as long as the command.
void add_body_options(CLI::App& command, BodyOptions& options);

// Warnings of the files go to stderr.
Body read_body(const BodyOptions& options, Progress& progress);

}  // namespace limber::cmd
