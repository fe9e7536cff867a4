// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/frame_timing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/platform/process.h"

namespace limber::editor {

namespace {

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

double milliseconds_of_thread() { return 1e3 * thread_cpu_seconds(); }

std::string in_words(const FrameLog::Parts& parts) {
  std::string words;
  for (const auto& [name, took] : parts) {
    char text[64];
    std::snprintf(text, sizeof text, "%s%s %.1f", words.empty() ? "" : ", ", name, took);
    words += text;
  }
  return words;
}

}  // namespace

void FrameLog::begin() {
  frame_ = {};
  begun_ = part_begun_ = std::chrono::steady_clock::now();
  computed_before_ = milliseconds_of_thread();
}

void FrameLog::part(const char* name) {
  frame_.parts.emplace_back(name, milliseconds_since(part_begun_));
  part_begun_ = std::chrono::steady_clock::now();
}

void FrameLog::end(const std::string& doing) {
  frame_.took = milliseconds_since(begun_);
  frame_.computed = milliseconds_of_thread() - computed_before_;
  frame_.doing = doing;
  frames_.push_back(std::move(frame_));
}

std::string FrameLog::text() const {
  char line[160];
  std::vector<double> took, computed;
  for (const Frame& frame : frames_) took.push_back(frame.took), computed.push_back(frame.computed);
  std::string text = "# " + std::to_string(frames_.size()) + " frames\n";
  for (const auto& [what, values] :
       {std::pair<const char*, const std::vector<double>&>{"ms", took}, {"ms computed", computed}}) {
    std::snprintf(line, sizeof line, "# %s: worst %.1f, 95th percentile %.1f, median %.1f\n", what,
                  percentile(values, 100), percentile(values, 95), percentile(values, 50));
    text += line;
  }
  const auto worst =
      std::max_element(frames_.begin(), frames_.end(), [](const Frame& a, const Frame& b) { return a.took < b.took; });
  if (worst != frames_.end())
    text += "# the worst is frame " + std::to_string(worst - frames_.begin() + 1) + ", " + worst->doing + ": " +
            in_words(worst->parts) + "\n";
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    std::snprintf(line, sizeof line, "%zu\t%.2f\t%.2f\t", i + 1, frames_[i].took, frames_[i].computed);
    text += line + frames_[i].doing + "\t" + in_words(frames_[i].parts) + "\n";
  }
  return text;
}

double percentile(std::vector<double> values, double percent) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double place = std::ceil(percent / 100 * static_cast<double>(values.size())) - 1;
  return values[static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(values.size() - 1)))];
}

}  // namespace limber::editor
