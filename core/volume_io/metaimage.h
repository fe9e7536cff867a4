// SPDX-License-Identifier: AGPL-3.0-or-later
// Parses headers of MetaImage files (.mha .mhd): lines `Key = value` up to ElementDataFile. TransformMatrix lists the
// direction of each voxel axis in the world (LPS, mm), one axis after the other. AnatomicalOrientation only describes
// the axes in words, so it is ignored.
#pragma once

#include <string_view>

#include "core/volume_io/volume_header.h"

namespace limber {

bool looks_like_meta_header(std::string_view bytes);

// Parses a header. Throws Error unless the header describes one scalar volume of 1 to 3 axes and its fields are
// consistent.
//   bytes  the file's first bytes            where  the file, for messages
VolumeHeader parse_meta_header(std::string_view bytes, const std::string& where);

}  // namespace limber
