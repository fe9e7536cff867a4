// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads the option for the frames of a sequence, FIRST:LAST[:STEP], and puts frame numbers in the place of {frame} in
// file names.
#pragma once

#include <string>
#include <vector>

namespace limber::cmd {

constexpr const char* kFrame = "{frame}";

// Returns the numbers of the frames that a request FIRST:LAST[:STEP] selects. Throws Error for a malformed request, or
// a request beyond the last of the motion's `frame_count` frames.
std::vector<int> frames_of(const std::string& request, int frame_count);

// Replaces each {frame} in the name by the frame's number with at least four digits.
std::string of_frame(std::string name, int frame);

// Returns the file name for each frame of the request if `name` contains {frame}; otherwise returns `name` alone.
std::vector<std::string> names_of(const std::string& name, const std::string& request);

}  // namespace limber::cmd
