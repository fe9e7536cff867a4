// SPDX-License-Identifier: AGPL-3.0-or-later
// Headers of NRRD files (.nrrd, .nhdr, .seg.nrrd), format versions 1 to 5: lines `field: value` and `key:=value` up to
// an empty line. Any anatomical space is turned to LPS mm. An axis of one sample that is no space axis (`list`, `none`)
// is passed over. SegmentN_ keys give names and colours, as 3D Slicer writes them.
#pragma once

#include <string>
#include <string_view>

#include "core/volume_io/volume_header.h"

namespace limber {

bool looks_like_nrrd_header(std::string_view bytes);

//   bytes  the file's first bytes            where  the file, for messages
//   throws Error for anything but one scalar volume of 1 to 3 axes that is described without contradiction
VolumeHeader parse_nrrd_header(std::string_view bytes, const std::string& where);

// The value of a `key:=value` line as it is written: backslashes and line ends are escaped.
std::string nrrd_escaped(std::string_view value);

}  // namespace limber
