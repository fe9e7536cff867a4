// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/cmd/frame_names.h"

#include <cstdint>
#include <cstdio>

#include "core/base/error.h"

namespace limber::cmd {

namespace {
// Upper limit on the number of frames for which output files are compared with the inputs. No motion has so many
// frames.
constexpr int kMostFrames = 100000;

struct FrameRange {
  int first = 0, last = 0, step = 1;
};

FrameRange frame_range_of(const std::string& request) {
  FrameRange range;
  int read = 0;
  const int fields = std::sscanf(request.c_str(), "%d:%d%n:%d%n", &range.first, &range.last, &read, &range.step, &read);
  if (fields < 2 || std::size_t(read) != request.size() || range.first < 0 || range.last < range.first ||
      range.step < 1)
    throw Error("these are no frames", "--frames " + request,
                "write FIRST:LAST or FIRST:LAST:STEP, as in --frames 0:90:10");
  return range;
}
}  // namespace

std::vector<int> frames_of(const std::string& request, int frame_count) {
  const auto [first, last, step] = frame_range_of(request);
  if (last >= frame_count)
    throw Error("the motion ends before that frame", "--frames " + request,
                "its last frame is " + std::to_string(frame_count - 1));
  std::vector<int> frames;
  for (std::int64_t frame = first; frame <= last; frame += step) frames.push_back(int(frame));
  return frames;
}

std::string of_frame(std::string name, int frame) {
  char number[16];
  std::snprintf(number, sizeof number, "%04d", frame);
  const std::string mark = kFrame;
  for (std::size_t at = 0; (at = name.find(mark, at)) != std::string::npos;) name.replace(at, mark.size(), number);
  return name;
}

std::vector<std::string> names_of(const std::string& name, const std::string& request) {
  if (request.empty() || name.find(kFrame) == std::string::npos) return {name};
  const auto [first, last, step] = frame_range_of(request);
  std::vector<std::string> names;
  for (std::int64_t frame = first; frame <= last && names.size() < kMostFrames; frame += step)
    names.push_back(of_frame(name, int(frame)));
  return names;
}

}  // namespace limber::cmd
