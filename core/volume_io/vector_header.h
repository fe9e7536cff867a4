// SPDX-License-Identifier: AGPL-3.0-or-later
// Parses headers of displacement fields. These are NRRD files whose first axis holds the three floats of a voxel.
#pragma once

#include <string>

#include "core/volume_io/volume_header.h"

namespace limber {

// Parses a header and returns it in the form of a scalar volume whose x axis has three times as many voxels. Throws
// Error unless the file has three floats per voxel in this machine's byte order.
//   bytes  the file's first bytes            where  the file, for messages
VolumeHeader parse_vector_header(std::string bytes, const std::string& where);

}  // namespace limber
