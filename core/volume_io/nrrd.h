// SPDX-License-Identifier: AGPL-3.0-or-later
// Parses headers of NRRD files (.nrrd, .nhdr, .seg.nrrd), format versions 1 to 5: lines `field: value` and `key:=value`
// up to an empty line. Coordinates of every anatomical space are converted to LPS, mm. An axis of only one sample that
// does not span space (kind `list`, direction `none`) is ignored. Names and colours of labels come from the keys
// SegmentN_..., which 3D Slicer writes.
#pragma once

#include <string>
#include <string_view>

#include "core/volume_io/volume_header.h"

namespace limber {

bool looks_like_nrrd_header(std::string_view bytes);

// Parses a header. Throws Error unless the header describes one scalar volume of 1 to 3 axes and its fields are
// consistent.
//   bytes  the file's first bytes            where  the file, for messages
VolumeHeader parse_nrrd_header(std::string_view bytes, const std::string& where);

// Returns `value` as it is written in a `key:=value` line: with escaped backslashes and line ends.
std::string nrrd_escaped(std::string_view value);

}  // namespace limber
