// SPDX-License-Identifier: AGPL-3.0-or-later
// Runs work that may crash, hang or use all memory in a process of its own: the same program runs `limber job FILE`,
// with the file that a cluster node would get. The worker's progress lines go to a Progress, and a cancel ends the
// worker at once. Whatever happens to it (a crash, a lack of memory, a limit of WorkerSettings) becomes one clear
// Error. The worker ends with the thread that runs it, and with the program.
//
// A worker reports its processor time every second. A worker that neither reports nor gains processor time (it is
// stopped, waits for a disk that does not answer, or is deadlocked) is shown as not answering, and is ended when that
// lasts. A worker that merely gets little processor time still gains some, so it runs on.
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

// The progress that a worker reports. Stage and fraction are always set; the other values only while it solves.
struct WorkerProgress {
  std::string stage;
  double fraction = 0;  // finished fraction of the stage, [0, 1]
  std::optional<double> angle_degrees, residual_mm, seconds_left;
  std::optional<int> iteration;
};

struct WorkerSettings {
  std::int64_t memory_limit_mb = 0;  // limit of the address space, MB; 0: none
  double time_limit = 0;             // seconds; 0: none
  double silence_shown = 10;         // seconds without a sign of work until the worker is shown as not answering
  double silence_limit = 600;        // seconds without a sign of work until the worker is ended; 0: never
  double patience = 0.05;            // seconds between asking the worker to end and killing it
  bool yields = false;               // true: the worker runs at idle priority
  Path program = "/proc/self/exe";
  std::function<void(const WorkerProgress&)> on_progress;  // called in run_worker's thread for each progress line
};

struct WorkerOutput {
  std::string text;                   // the worker's standard output, at most 16 MB of it
  std::vector<std::string> warnings;  // one line each
  bool pose_reached = true;           // false: the worker wrote the last pose that it could solve; warnings say more
};

// Runs the job to its end and blocks meanwhile, so call it in a Job. Throws Error with what went wrong, and Cancelled
// after a cancel.
WorkerOutput run_worker(const Path& job_file, Progress& progress, const WorkerSettings& settings = {});

// Call this in the worker before it starts any thread. Sets the memory limit. Lowers the priority below all other
// programs if `yields` is true. Lets the worker die with `parent`, the id of the process that started it (0: none).
void become_worker(std::int64_t memory_limit_mb, bool yields, int parent);

// The stage name that is shown for a worker that does not answer.
constexpr const char* kNotAnswering = "no answer";

// Writes a sign of life of the worker every second while this object lives: a line of JSON with the worker's processor
// time, on the error stream.
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
