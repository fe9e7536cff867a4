// SPDX-License-Identifier: AGPL-3.0-or-later
// Puts the numbers of a sequence's frames in the place of {frame} in file names.
#pragma once

#include <string>
#include <vector>

namespace limber::cmd {

constexpr const char* kFrame = "{frame}";

// Replaces each {frame} in the name by the frame's number with at least four digits.
std::string of_frame(std::string name, int frame);

// Returns the file name for each frame of the request (core/motion/frame_range.h) if `name` contains {frame}; otherwise
// returns `name` alone. Throws Error for a malformed request.
std::vector<std::string> names_of(const std::string& name, const std::string& request);

}  // namespace limber::cmd
