// SPDX-License-Identifier: AGPL-3.0-or-later
// Replaces {frame} in file names by the number of a sequence's frame.
#pragma once

#include <string>
#include <vector>

namespace limber::cmd {

constexpr const char* kFrame = "{frame}";

// Returns the name with each {frame} replaced by the frame's number, which has at least four digits.
std::string of_frame(std::string name, int frame);

// Returns the file name for each frame of the request (core/motion/frame_range.h) if `name` contains {frame}; otherwise
// returns `name` alone. Throws Error for a malformed request.
std::vector<std::string> names_of(const std::string& name, const std::string& request);

}  // namespace limber::cmd
