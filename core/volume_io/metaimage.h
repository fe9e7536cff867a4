// SPDX-License-Identifier: AGPL-3.0-or-later
// Headers of MetaImage files (.mha .mhd): lines `Key = value` up to ElementDataFile. TransformMatrix holds the world
// axis of each voxel axis in turn; world is LPS, mm. AnatomicalOrientation only describes and is not used.
#pragma once

#include <string_view>

#include "core/volume_io/volume_header.h"

namespace limber {

bool looks_like_meta_header(std::string_view bytes);

//   bytes  the file's first bytes            where  the file, for messages
//   throws Error for anything but one scalar volume of 1 to 3 axes that is described without contradiction
VolumeHeader parse_meta_header(std::string_view bytes, const std::string& where);

}  // namespace limber
