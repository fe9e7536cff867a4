// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures how long frames take in the thread that draws them. Times are those of the computer's clock, since a
// script's own clock is simulated.
//
// Each frame has two times in milliseconds: the time from its begin to its end, including waits for OpenGL, and the CPU
// time of the drawing thread. The first time is split into parts ("input", "body", "panels") in the order in which they
// ended. When a script runs, the time in which the window is painted for the script's pictures is not counted.
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
    double took = 0, computed = 0;  // time from begin to end, and CPU time, ms
    Parts parts;
    std::string doing;
  };

  void begin();
  // Ends a part of the frame and names it. The part began where the previous part of the frame ended. `name` must be a
  // string literal.
  void part(const char* name);
  void end(const std::string& doing);  // ends the frame; `doing` says why it was drawn
  const std::vector<Frame>& frames() const { return frames_; }
  void clear() { frames_.clear(); }

  // Returns a summary in lines that begin with "#" (worst time, 95th percentile, median, parts of the worst frame),
  // then one line for each frame: number, time, CPU time, why it was drawn, its parts. Times are in ms.
  std::string text() const;

 private:
  std::vector<Frame> frames_;
  Frame frame_;
  std::chrono::steady_clock::time_point begun_, part_begun_;
  double computed_before_ = 0;
};

// Returns the percentile: the smallest value that at least `percent` percent of the values do not exceed. Returns 0 if
// there are no values.
double percentile(std::vector<double> values, double percent);

}  // namespace limber::editor
