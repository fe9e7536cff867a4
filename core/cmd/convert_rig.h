// SPDX-License-Identifier: AGPL-3.0-or-later
// Converts rigs and motions for the command `convert`.
#pragma once

#include "core/base/file.h"

namespace limber::cmd {

// Converts a rig or a motion. A .bvh output keeps the frames of a motion; other formats get only the rest pose.
// Warnings go to stderr.
void convert_rig_or_motion(const Path& in, const Path& out);

}  // namespace limber::cmd
