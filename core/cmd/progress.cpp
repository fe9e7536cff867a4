// SPDX-License-Identifier: AGPL-3.0-or-later
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include <nlohmann/json.hpp>

#include "core/cmd/command.h"
#include "core/platform/terminal.h"

namespace limber::cmd {

namespace {
constexpr const char* kErase = "\r\033[K";  // erases the line on a terminal

// These variables are global because a signal handler can access only global variables.
volatile std::sig_atomic_t interrupted = 0;
volatile std::sig_atomic_t leaves_at_once = 0;
void on_interrupt(int) {
  interrupted = 1;
  if (leaves_at_once) std::_Exit(3);
}
}  // namespace

void warn(const std::string& line) { tell("limber: warning: " + line); }
void warn(const std::vector<std::string>& lines) {
  for (const auto& line : lines) warn(line);
}

void tell_failed_gates(const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) tell("limber: gate failed: " + sentence);
}

CommandProgress::CommandProgress(const std::string& mode)
    : mode_(mode == "json"               ? Mode::Json
            : error_stream_is_terminal() ? Mode::Bar
                                         : Mode::Silent) {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

CommandProgress::~CommandProgress() {
  if (mode_ == Mode::Bar && !stage_.empty()) draw_bar(kErase);
}

CommandProgress::LeavesAtOnce::LeavesAtOnce() { leaves_at_once = 1; }
CommandProgress::LeavesAtOnce::~LeavesAtOnce() { leaves_at_once = 0; }

void CommandProgress::show(const Iteration& iteration) {
  if (mode_ != Mode::Json) return update("solving", iteration.fraction);
  stage_ = "solving";
  shown_ = iteration.fraction;
  tell(nlohmann::json{{"stage", "solving"},
                      {"fraction", iteration.fraction},
                      {"angle_degrees", iteration.angle_degrees},
                      {"iteration", iteration.iteration},
                      {"residual_mm", iteration.residual_mm},
                      {"seconds_left", iteration.seconds_left}}
           .dump());
}

bool CommandProgress::cancelled() const { return interrupted != 0 || Progress::cancelled(); }

void CommandProgress::on_update(std::string_view stage, double fraction) {
  const bool new_stage = stage != stage_;
  if (!new_stage && fraction < 1 && fraction - shown_ < 0.01) return;
  stage_ = stage;
  shown_ = fraction;
  if (mode_ == Mode::Json) {
    tell(nlohmann::json{{"stage", stage_}, {"fraction", fraction}}.dump());
  } else if (mode_ == Mode::Bar) {
    constexpr int kWidth = 32;
    const int full = static_cast<int>(fraction * kWidth + 0.5);
    char percent[16];
    std::snprintf(percent, sizeof percent, "] %3.0f %%", fraction * 100);
    std::string bar = one_line(stage_);
    bar.resize(std::max(bar.size(), std::size_t{12}), ' ');
    draw_bar(kErase + bar + " [" + std::string(full, '#') + std::string(kWidth - full, ' ') + percent +
             (fraction >= 1 ? kErase : ""));
  }
}

void add_run_options(CLI::App& command, RunOptions& options) {
  command.add_option("--threads", options.threads, "threads to use (default: every core)")->check(CLI::Range(1, 1024));
  command
      .add_option("--progress", options.progress,
                  "with the value json: print progress to stderr, one line of JSON per step (default: a progress bar)")
      ->check(CLI::IsMember({"json"}));
}

}  // namespace limber::cmd
