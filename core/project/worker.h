// SPDX-License-Identifier: AGPL-3.0-or-later
// Work that may crash, hang or eat all memory, in a process of its own: the same program runs `limber job FILE`, the
// file a cluster node would get. Its progress lines go on to a Progress, a cancel ends it at once, and whatever happens
// to it (a crash, the system's lack of memory, a limit of ours) is one clear Error here. It dies with the thread that
// runs it, and with the program.
//
// A worker tells every second how much processor time it has taken. One that neither tells nor works any more (it is
// stopped, waits for a disk that does not answer, or for itself) is shown as not answering, and ended when that lasts.
// One that is merely starved still gets a little of the processor, and goes on.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/progress.h"

namespace limber {

// What the worker tells of itself: stage and fraction always, the rest while it solves.
struct WorkerProgress {
  std::string stage;
  double fraction = 0;  // of the stage, [0, 1]
  std::optional<double> angle_degrees, residual_mm, seconds_left;
  std::optional<int> iteration;
};

struct WorkerSettings {
  std::int64_t memory_limit_mb = 0;  // of address space; 0: none
  double time_limit = 0;             // seconds; 0: none
  double silence_shown = 10;         // seconds without a sign of work, from when on that is its stage
  double silence_limit = 600;        // seconds without a sign of work until it is ended; 0: never
  double patience = 0.05;            // seconds between asking it to end and ending it
  bool yields = false;               // takes of the machine what all others leave
  Path program = "/proc/self/exe";
  std::function<void(const WorkerProgress&)> on_progress;  // in the thread that runs it; each line that has come
};

struct WorkerOutput {
  std::string text;                   // what it printed, at most 16 MB of it
  std::vector<std::string> warnings;  // one line each
  bool pose_reached = true;  // false: what it wrote is the last place on the way to the pose; a warning says more
};

// Runs the job to its end; blocks, so it belongs into a Job. throws Error with what went wrong, Cancelled after a
// cancel.
WorkerOutput run_worker(const Path& job_file, Progress& progress, const WorkerSettings& settings = {});

// In the worker, before it starts any thread: limits its memory, lets it yield to all others, and lets it die with
// `parent`, the process that started it (0: none).
void become_worker(std::int64_t memory_limit_mb, bool yields, int parent);

// What a worker that does not answer is shown as.
constexpr const char* kNotAnswering = "no answer";

// In the worker, while it lives: the sign of life, a line of JSON on the error stream every second.
class Heartbeat {
 public:
  Heartbeat();
  ~Heartbeat();
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

 private:
  struct Beating;
  std::unique_ptr<Beating> beating_;
};

}  // namespace limber
