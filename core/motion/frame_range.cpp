// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/frame_range.h"

#include <cstdint>
#include <cstdio>

#include "core/base/error.h"

namespace limber {

FrameRange frame_range_of(const std::string& request, const std::string& where) {
  FrameRange range;
  int read = 0;
  const int fields = std::sscanf(request.c_str(), "%d:%d%n:%d%n", &range.first, &range.last, &read, &range.step, &read);
  if (fields < 2 || std::size_t(read) != request.size() || range.first < 0 || range.last < range.first ||
      range.step < 1)
    throw Error("this is not a range of frames", where, "write FIRST:LAST or FIRST:LAST:STEP, as in 0:90:10");
  return range;
}

std::vector<int> frames_in(const std::string& request, int frame_count, const std::string& where) {
  const auto [first, last, step] = frame_range_of(request, where);
  if (last >= frame_count)
    throw Error("the motion ends before that frame", where, "its last frame is " + std::to_string(frame_count - 1));
  std::vector<int> frames;
  for (std::int64_t frame = first; frame <= last; frame += step) frames.push_back(int(frame));
  return frames;
}

}  // namespace limber
