// SPDX-License-Identifier: AGPL-3.0-or-later
// What `convert` does for rigs and motions.
#pragma once

#include "core/base/file.h"

namespace limber::cmd {

// A motion to a .bvh keeps its frames; to another name, and for any rig, the rest pose is written. Warnings go to
// stderr.
void convert_rig_or_motion(const Path& in, const Path& out);

}  // namespace limber::cmd
