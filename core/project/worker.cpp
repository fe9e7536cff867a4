// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/worker.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/platform/child_program.h"
#include "core/platform/pipe.h"
#include "core/platform/process.h"
#include "core/platform/terminal.h"

namespace limber {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPollMilliseconds = 20, kEndingMilliseconds = 5;
constexpr double kDying = 0.01;  // seconds to wait for a killed worker process to end
constexpr std::size_t kMostOutput = std::size_t{16} << 20;
constexpr std::size_t kLongestLine = std::size_t{1} << 16;
constexpr std::size_t kMostWarnings = 1000;
constexpr auto kBeat = std::chrono::seconds(1);
// Processor time that a worker must use between two heartbeats to count as working, seconds. Writing a heartbeat itself
// uses about a tenth of this time.
constexpr double kLeastWork = .001;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

Pipe pipe_from_worker() {
  std::error_code error;
  Pipe pipe = make_pipe(error);
  if (error) throw Error("a worker cannot be started", "pipe", error.message());
  return pipe;
}

// Calls take(bytes, size) with the bytes that can be read now. Closes the pipe at the end of the stream.
template <class Take>
void drain(Pipe& pipe, const Take& take) {
  std::array<char, 1 << 14> block;
  while (pipe.read_end.is_open()) {
    const std::ptrdiff_t got = read_some(pipe.read_end, block.data(), block.size());
    if (got < 0) return;
    if (got > 0) take(block.data(), static_cast<std::size_t>(got));
    else pipe.read_end.close();
  }
}

// Reads the lines that the worker writes to its error stream.
class Listener {
 public:
  Listener(Progress& progress, const std::function<void(const WorkerProgress&)>& on_progress)
      : progress_(progress),
        on_progress_(on_progress) {}
  void take(const char* bytes, std::size_t size) {
    for (const char* end = bytes + size; bytes < end;) {
      const char* line_end = std::find(bytes, end, '\n');
      line_.append(bytes, std::min<std::size_t>(line_end - bytes, kLongestLine - std::min(kLongestLine, line_.size())));
      if (line_end == end) return;
      on_line();
      line_.clear();
      bytes = line_end + 1;
    }
  }
  // Returns the seconds since the worker's last sign of work. Reports the worker as not answering when they exceed
  // `shown`. Reports its last progress again once it answers.
  double silence(double shown) {
    const double seconds = seconds_since(sign_);
    const bool silent = seconds > shown;
    if (silent != silent_) tell(silent ? WorkerProgress{kNotAnswering, 0, {}, {}, {}, {}} : last_);
    silent_ = silent;
    return seconds;
  }
  std::vector<std::string> warnings;
  std::string complaint;  // the worker's last line that is neither progress nor a warning

 private:
  void on_line() {
    constexpr std::string_view kWarning = "limber: warning: ", kName = "limber: ";
    if (line_.starts_with('{')) {
      const auto json = nlohmann::json::parse(sound_json(line_), nullptr, false);
      if (json.is_object() && json.contains("processor_seconds"))
        return on_beat(number(json, "processor_seconds").value_or(0));
      if (!json.is_object() || !json.contains("stage") || !json["stage"].is_string()) return;
      if (!json.contains("fraction") || !json["fraction"].is_number()) return;
      WorkerProgress now{json["stage"].get<std::string>(), json["fraction"].get<double>(),
                         number(json, "angle_degrees"),    number(json, "residual_mm"),
                         number(json, "seconds_left"),     {}};
      if (const auto iteration = number(json, "iteration")) now.iteration = static_cast<int>(*iteration);
      sign_ = Clock::now();
      last_ = std::move(now);
      silent_ = false;
      tell(last_);
    } else if (line_.starts_with(kWarning)) {
      if (warnings.size() < kMostWarnings) warnings.push_back(line_.substr(kWarning.size()));
    } else if (!line_.empty()) {
      complaint = line_.starts_with(kName) ? line_.substr(kName.size()) : line_;
    }
  }
  void on_beat(double processor_seconds) {
    if (processor_seconds - worked_ < kLeastWork) return;
    worked_ = processor_seconds;
    sign_ = Clock::now();
  }
  void tell(const WorkerProgress& now) {
    if (now.stage.empty() || progress_.cancelled()) return;
    progress_.update(now.stage, now.fraction);
    if (on_progress_) on_progress_(now);
  }
  static std::optional<double> number(const nlohmann::json& json, const char* key) {
    return json.contains(key) && json[key].is_number() ? std::optional(json[key].get<double>()) : std::nullopt;
  }
  Progress& progress_;
  const std::function<void(const WorkerProgress&)>& on_progress_;
  std::string line_;
  Clock::time_point sign_ = Clock::now();
  double worked_ = 0;  // processor time of the worker at its last sign of work, seconds
  bool silent_ = false;
  WorkerProgress last_;
};

// Turns the worker's error message, of the form "what: where: what to do", into an Error.
Error relay(const std::string& line, const Path& job) {
  const std::size_t first = line.find(": "), last = line.rfind(": ");
  if (first == std::string::npos || first == last)
    return {"the worker failed", job.string(), line.empty() ? "the worker gave no reason" : line};
  return {line.substr(0, first), line.substr(first + 2, last - first - 2), line.substr(last + 2)};
}

Error death(const ProgramEnd& end, const Path& job) {
  if (end.was_killed())
    return {"the worker was ended by the system, most likely for lack of memory", job.string(),
            "use a coarser spacing, or close other programs"};
  return {"the worker crashed", job.string() + ", " + end.signal_text(),
          "try other settings, and please report the settings that failed"};
}

}  // namespace

WorkerOutput run_worker(const Path& job_file, Progress& progress, const WorkerSettings& settings) {
  if (progress.cancelled()) throw Cancelled();
  std::vector<std::string> words{"limber", "job",      job_file.string(),           "--progress",
                                 "json",   "--parent", std::to_string(process_id())};
  if (settings.memory_limit_mb > 0)
    words.insert(words.end(), {"--memory-limit", std::to_string(settings.memory_limit_mb)});
  if (settings.yields) words.push_back("--yield");

  Pipe out = pipe_from_worker(), err = pipe_from_worker();
  std::error_code error;
  const Streams streams{.out = &out.write_end, .err = &err.write_end};
  ChildProgram process(settings.program, std::move(words), streams, Environment::Same, error);
  if (error) throw Error("a worker cannot be started", settings.program.string(), error.message());
  out.write_end.close();
  err.write_end.close();

  WorkerOutput output;
  Listener listener(progress, settings.on_progress);
  const auto take_out = [&](const char* bytes, std::size_t size) {
    output.text.append(bytes, std::min(size, kMostOutput - std::min(kMostOutput, output.text.size())));
  };
  const auto take_err = [&](const char* bytes, std::size_t size) { listener.take(bytes, size); };

  enum class Stop { None, Cancel, Time, Silence } stop = Stop::None;
  const auto started = Clock::now();
  Clock::time_point asked, killed;
  while (!process.has_ended()) {
    wait_to_read({&out.read_end, &err.read_end}, stop == Stop::None ? kPollMilliseconds : kEndingMilliseconds);
    drain(out, take_out);
    drain(err, take_err);
    if (stop == Stop::None) {
      if (progress.cancelled()) stop = Stop::Cancel;
      const double silence = listener.silence(settings.silence_shown);
      if (settings.silence_limit > 0 && silence > settings.silence_limit) stop = Stop::Silence;
      if (settings.time_limit > 0 && seconds_since(started) > settings.time_limit) stop = Stop::Time;
      if (stop == Stop::None) continue;
      asked = Clock::now();
      process.ask_to_end();
    } else if (killed == Clock::time_point() && seconds_since(asked) > settings.patience) {
      killed = Clock::now();
      process.kill();
    } else if (killed != Clock::time_point() && seconds_since(killed) > kDying) {
      break;
    }
  }
  drain(out, take_out);
  drain(err, take_err);
  output.warnings = std::move(listener.warnings);

  if (stop == Stop::Cancel || progress.cancelled()) throw Cancelled();
  if (stop == Stop::Time)
    throw Error("the worker took longer than " + std::to_string(static_cast<long>(settings.time_limit)) + " s",
                job_file.string(), "raise the time limit, or use a coarser spacing");
  if (stop == Stop::Silence)
    throw Error("the worker stopped answering and was ended after " +
                    std::to_string(static_cast<long>(settings.silence_limit)) + " s",
                job_file.string(),
                "run the job again; if this happens again, use a coarser spacing, and check the disk");
  const ProgramEnd& end = process.end();
  if (end.by_signal()) throw death(end, job_file);
  if (end.exit_code == 3) throw Cancelled();
  output.pose_reached = end.exit_code != 4;
  if (end.exit_code != 0 && output.pose_reached) throw relay(listener.complaint, job_file);
  return output;
}

struct Heartbeat::Beating {
  std::mutex mutex;
  std::condition_variable_any changed;
  std::jthread thread;
};

Heartbeat::Heartbeat() : beating_(std::make_unique<Beating>()) {
  beating_->thread = std::jthread([beating = beating_.get()](const std::stop_token& stop) {
    std::unique_lock lock(beating->mutex);
    while (!beating->changed.wait_for(lock, stop, kBeat, [&] { return stop.stop_requested(); })) {
      char line[64];
      std::snprintf(line, sizeof line, "{\"processor_seconds\": %.6f}\n", own_cpu_seconds());
      if (!write_error_stream(line)) return;
    }
  });
}

Heartbeat::~Heartbeat() {
  beating_->thread.request_stop();
  beating_->changed.notify_all();
}

void become_worker(std::int64_t memory_limit_mb, bool yields, int parent) {
  if (parent > 0 && !end_with_parent(parent)) std::_Exit(3);
  if (yields) yield_to_other_programs();
  if (memory_limit_mb <= 0) return;
  if (const std::error_code error = limit_memory(memory_limit_mb << 20))
    throw Error("the memory limit cannot be set", std::to_string(memory_limit_mb) + " MB", error.message());
}

}  // namespace limber
