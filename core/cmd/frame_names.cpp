// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/frame_names.h"

#include <cstdint>
#include <cstdio>

#include "core/motion/frame_range.h"

namespace limber::cmd {

namespace {
// Output files of frames beyond this number are not compared with the inputs. No motion has so many frames.
constexpr int kMostFrames = 100000;
}  // namespace

std::string of_frame(std::string name, int frame) {
  char number[16];
  std::snprintf(number, sizeof number, "%04d", frame);
  const std::string mark = kFrame;
  for (std::size_t at = 0; (at = name.find(mark, at)) != std::string::npos;) name.replace(at, mark.size(), number);
  return name;
}

std::vector<std::string> names_of(const std::string& name, const std::string& request) {
  if (request.empty() || name.find(kFrame) == std::string::npos) return {name};
  const auto [first, last, step] = frame_range_of(request, "--frames " + request);
  std::vector<std::string> names;
  for (std::int64_t frame = first; frame <= last && names.size() < kMostFrames; frame += step)
    names.push_back(of_frame(name, int(frame)));
  return names;
}

}  // namespace limber::cmd
