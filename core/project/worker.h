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
#include "core/platform/module.h"

namespace limber {

// The progress that a worker reports. Stage and fraction are always set; the other values only while the FEM solver
// runs.
struct WorkerProgress {
  std::string stage;
  double fraction = 0;  // finished fraction of the stage, [0, 1]
  std::optional<double> angle_degrees, residual_mm, seconds_left;
  std::optional<int> iteration;
};

struct WorkerSettings {
  std::int64_t memory_limit_mb = 0;  // limit of the worker's address space, MB; 0: none
  double time_limit = 0;             // limit of the running time, seconds; 0: none
  double silence_shown = 10;         // seconds without sign of work until the worker is shown as not answering
  double silence_limit = 600;        // seconds without a sign of work until the worker is ended; 0: never
  double patience = 0.05;            // seconds between the request to end and killing the worker
  bool yields = false;               // true: the worker runs at idle priority
  Path program = running_program();
  std::function<void(const WorkerProgress&)> on_progress;  // called in run_worker's thread for each progress line
};

struct WorkerOutput {
  std::string text;                   // the worker's standard output, at most 16 MB of it
  std::vector<std::string> warnings;  // one line for each warning
  bool pose_reached = true;           // false: the solver stopped early and wrote the last pose it solved; see warnings
};

// Runs the job in a worker process and blocks until it ends, so call this function inside a Job. Throws Error with the
// worker's message or the cause of its end, and Cancelled after a cancel.
WorkerOutput run_worker(const Path& job_file, Progress& progress, const WorkerSettings& settings = {});

// Call this function in the worker process before it starts any thread. It sets the memory limit. If `yields` is true,
// it lowers the priority below all other programs. It makes the worker end together with `parent`, the id of the
// process that started it (0: none).
void become_worker(std::int64_t memory_limit_mb, bool yields, int parent);

// The stage that a worker's progress shows while the worker does not answer.
constexpr const char* kNotAnswering = "no answer";

// While this object lives, writes a line of JSON with the worker's processor time to the error stream every second. The
// parent process takes it as a sign of life.
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
