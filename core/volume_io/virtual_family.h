// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes Virtual Family voxel models [Christ et al. 2010]. NAME.raw has one or two bytes per voxel, x
// fastest. NAME.txt has a line `number red green blue name` per tissue, then the number of voxels (`nx N`, `ny N`, `nz
// N`) and their size in metres (`dx`, `dy`, `dz`). The format has no position in the world: the first voxel's centre is
// the origin, and the axes are LPS.
#pragma once

#include <string>
#include <string_view>

#include "core/volume_io/volume_header.h"

namespace limber {

bool looks_like_virtual_family(std::string_view text);

// Parses the text file. Throws an Error that names the wrong line.
//   text       content of the .txt file        raw_bytes  size of the .raw file
VolumeHeader parse_virtual_family(std::string_view text, std::int64_t raw_bytes, const std::string& where);
std::string make_virtual_family(const Grid& grid, const TissueTable& tissues);

}  // namespace limber
