// SPDX-License-Identifier: AGPL-3.0-or-later
// Headers of displacement fields: NRRD with three floats a voxel, the three together along the first axis.
#pragma once

#include <string>

#include "core/volume_io/volume_header.h"

namespace limber {

// As the header of a volume of single numbers, three times as long in x.
//   bytes  the file's first bytes            where  the file, for messages
//   throws Error for anything but three floats a voxel in this machine's order of bytes
VolumeHeader parse_vector_header(std::string bytes, const std::string& where);

}  // namespace limber
