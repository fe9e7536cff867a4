// SPDX-License-Identifier: AGPL-3.0-or-later
// Virtual Family voxel models [Christ et al. 2010]: NAME.raw, one or two bytes a voxel, x fastest, beside NAME.txt with
// lines `number red green blue name` for the tissues, then `nx N` `ny N` `nz N` cells and `dx` `dy` `dz` in metres. The
// format knows no place in the world: the first voxel's centre is the origin, axes are LPS.
#pragma once

#include <string>
#include <string_view>

#include "core/volume_io/volume_header.h"

namespace limber {

bool looks_like_virtual_family(std::string_view text);

//   text       the .txt file        raw_bytes  size of the .raw file        throws Error naming the line
VolumeHeader parse_virtual_family(std::string_view text, std::int64_t raw_bytes, const std::string& where);
std::string make_virtual_family(const Grid& grid, const TissueTable& tissues);

}  // namespace limber
