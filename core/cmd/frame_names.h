// SPDX-License-Identifier: AGPL-3.0-or-later
// The frames of a sequence, FIRST:LAST[:STEP], and the names of their files, which hold {frame}.
#pragma once

#include <string>
#include <vector>

namespace limber::cmd {

constexpr const char* kFrame = "{frame}";

// Of a motion with so many frames.   throws Error for what is no request, or goes beyond the motion
std::vector<int> frames_of(const std::string& request, int frame_count);

// The name with the frame's number, of four digits or more, in place of each {frame}.
std::string of_frame(std::string name, int frame);

// The names that `name` stands for: one a frame of the request where it holds {frame}, else itself.
std::vector<std::string> names_of(const std::string& name, const std::string& request);

}  // namespace limber::cmd
