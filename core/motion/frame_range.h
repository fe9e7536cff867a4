// SPDX-License-Identifier: AGPL-3.0-or-later
// Parses a range of frames: FIRST:LAST or FIRST:LAST:STEP. Frames count from 0, and LAST is included.
#pragma once

#include <string>
#include <vector>

namespace limber {

struct FrameRange {
  int first = 0, last = 0, step = 1;
};

// Parses a range such as "0:60:5". Throws Error if it is malformed.
//   where  names the source of the text in the error message: "--frames 0:60:5"
FrameRange frame_range_of(const std::string& request, const std::string& where);

// Returns the numbers of the frames that a request selects: 0, 5, ..., 60 for "0:60:5". Throws Error for a malformed
// request, and for one beyond the last of the motion's `frame_count` frames.
std::vector<int> frames_in(const std::string& request, int frame_count, const std::string& where);

}  // namespace limber
