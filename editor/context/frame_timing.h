// SPDX-License-Identifier: AGPL-3.0-or-later
// What frames cost the thread that draws them, on real clocks: a script's own time is fixed and says nothing of it.
//
// Of every frame two times are kept, in milliseconds: how long it took, waiting for OpenGL included, and how long this
// thread computed. The first is told by parts ("input", "body", "panels") in the order in which they ended. A script's
// window is painted only for its pictures, which no frame counts.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace limber::editor {

class FrameLog {
 public:
  using Parts = std::vector<std::pair<const char*, double>>;
  struct Frame {
    double took = 0, computed = 0;  // ms
    Parts parts;
    std::string doing;
  };

  void begin();
  void part(const char* name);         // what was done since the part before; literals only
  void end(const std::string& doing);  // of the frame: for what it was drawn
  const std::vector<Frame>& frames() const { return frames_; }
  void clear() { frames_.clear(); }

  // A summary in lines that begin with "#" (worst, 95th percentile, median; what the worst frame did), then one frame a
  // line: number, ms, ms computed, what it was drawn for, its parts.
  std::string text() const;

 private:
  std::vector<Frame> frames_;
  Frame frame_;
  std::chrono::steady_clock::time_point begun_, part_begun_;
  double computed_before_ = 0;
};

// The value that so many percent of the others do not exceed; 0 of none.
double percentile(std::vector<double> values, double percent);

}  // namespace limber::editor
