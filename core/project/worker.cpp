// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/worker.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_text.h"
#include "core/base/spawn.h"

namespace limber {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPollMilliseconds = 20, kEndingMilliseconds = 5;
constexpr double kDying = 0.01;  // seconds to wait for a killed worker process to end
constexpr std::size_t kMostOutput = std::size_t{16} << 20;
constexpr std::size_t kLongestLine = std::size_t{1} << 16;
constexpr std::size_t kMostWarnings = 1000;
constexpr auto kBeat = std::chrono::seconds(1);
// Processor time that a worker must use between two heartbeats to count as working, seconds. A heartbeat itself uses
// about a tenth of it.
constexpr double kLeastWork = .001;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// A pipe whose ends are not inherited by the programs that this process starts.
struct Pipe {
  int read_end = -1, write_end = -1;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw Error("a worker cannot be started", "pipe", std::strerror(errno));
    read_end = ends[0];
    write_end = ends[1];
    ::fcntl(read_end, F_SETFL, O_NONBLOCK);
  }
  ~Pipe() {
    close_write();
    if (read_end >= 0) ::close(read_end);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_write() {
    if (write_end >= 0) ::close(std::exchange(write_end, -1));
  }
  // Calls take(bytes, size) with the bytes that can be read now. Returns false at the end of the stream.
  template <class Take>
  bool drain(const Take& take) const {
    std::array<char, 1 << 14> block;
    for (;;) {
      const ssize_t got = ::read(read_end, block.data(), block.size());
      if (got > 0) take(block.data(), static_cast<std::size_t>(got));
      else if (got == 0) return false;
      else if (errno != EINTR) return errno == EAGAIN;
    }
  }
};

void bury(pid_t process) {
  while (::waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
  }
}

// The worker process. It has a process group of its own, so that its children end with it. The destructor kills the
// worker without waiting. A worker at idle priority can take long to free its memory after the kill, so another thread
// waits for its end.
class Process {
 public:
  Process(const Path& program, const std::vector<std::string>& arguments, const Pipe& out, const Pipe& err) {
    std::vector<std::string> words{"limber"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const Streams streams{.out = out.write_end, .err = err.write_end};
    id_ = spawn(program, std::move(words), streams, Environment::Same, "a worker");
  }
  ~Process() {
    if (ended_) return;
    send(SIGKILL);
    try {
      std::thread(bury, id_).detach();
    } catch (const std::system_error&) {
      bury(id_);
    }
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void send(int signal) const { ::kill(-id_, signal); }
  // Returns true if the worker has ended. If so, kills the processes that it left in its group, before the system can
  // reuse the worker's process id.
  bool has_ended() {
    siginfo_t info{};
    if (ended_ || ::waitid(P_PID, static_cast<id_t>(id_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
        info.si_pid != id_)
      return ended_;
    send(SIGKILL);
    while (::waitpid(id_, &status_, 0) < 0 && errno == EINTR) {
    }
    return ended_ = true;
  }
  int status() const { return status_; }

 private:
  pid_t id_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

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
    return {"the worker failed", job.string(), line.empty() ? "it gave no reason" : line};
  return {line.substr(0, first), line.substr(first + 2, last - first - 2), line.substr(last + 2)};
}

Error death(int signal, const Path& job) {
  if (signal == SIGKILL)
    return {"the worker was ended by the system, most likely for lack of memory", job.string(),
            "use a coarser spacing, or close other programs"};
  return {"the worker crashed", job.string() + ", " + ::strsignal(signal),
          "try other settings, and please report what you asked for"};
}

}  // namespace

WorkerOutput run_worker(const Path& job_file, Progress& progress, const WorkerSettings& settings) {
  if (progress.cancelled()) throw Cancelled();
  std::vector<std::string> arguments{"job",  job_file.string(), "--progress",
                                     "json", "--parent",        std::to_string(::getpid())};
  if (settings.memory_limit_mb > 0)
    arguments.insert(arguments.end(), {"--memory-limit", std::to_string(settings.memory_limit_mb)});

  if (settings.yields) arguments.push_back("--yield");

  Pipe out, err;
  Process process(settings.program, arguments, out, err);
  out.close_write();
  err.close_write();

  WorkerOutput output;
  Listener listener(progress, settings.on_progress);
  const auto take_out = [&](const char* bytes, std::size_t size) {
    output.text.append(bytes, std::min(size, kMostOutput - std::min(kMostOutput, output.text.size())));
  };
  const auto take_err = [&](const char* bytes, std::size_t size) { listener.take(bytes, size); };

  enum class Stop { None, Cancel, Time, Silence } stop = Stop::None;
  const auto started = Clock::now();
  Clock::time_point asked, killed;
  bool out_open = true, err_open = true;
  while (!process.has_ended()) {
    pollfd ends[2] = {{out_open ? out.read_end : -1, POLLIN, 0}, {err_open ? err.read_end : -1, POLLIN, 0}};
    ::poll(ends, 2, stop == Stop::None ? kPollMilliseconds : kEndingMilliseconds);
    if (out_open && ends[0].revents) out_open = out.drain(take_out);
    if (err_open && ends[1].revents) err_open = err.drain(take_err);
    if (stop == Stop::None) {
      if (progress.cancelled()) stop = Stop::Cancel;
      const double silence = listener.silence(settings.silence_shown);
      if (settings.silence_limit > 0 && silence > settings.silence_limit) stop = Stop::Silence;
      if (settings.time_limit > 0 && seconds_since(started) > settings.time_limit) stop = Stop::Time;
      if (stop == Stop::None) continue;
      asked = Clock::now();
      process.send(SIGTERM);
    } else if (killed == Clock::time_point() && seconds_since(asked) > settings.patience) {
      killed = Clock::now();
      process.send(SIGKILL);
    } else if (killed != Clock::time_point() && seconds_since(killed) > kDying) {
      break;
    }
  }
  out.drain(take_out);
  err.drain(take_err);
  output.warnings = std::move(listener.warnings);

  if (stop == Stop::Cancel || progress.cancelled()) throw Cancelled();
  if (stop == Stop::Time)
    throw Error("the worker took longer than " + std::to_string(static_cast<long>(settings.time_limit)) + " s",
                job_file.string(), "raise the time limit, or use a coarser spacing");
  if (stop == Stop::Silence)
    throw Error("the worker stopped answering and was ended after " +
                    std::to_string(static_cast<long>(settings.silence_limit)) + " s",
                job_file.string(), "run it again; if that happens again use a coarser spacing, and check the disk");
  const int status = process.status();
  if (WIFSIGNALED(status)) throw death(WTERMSIG(status), job_file);
  if (WEXITSTATUS(status) == 3) throw Cancelled();
  output.pose_reached = WEXITSTATUS(status) != 4;
  if (WEXITSTATUS(status) != 0 && output.pose_reached) throw relay(listener.complaint, job_file);
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
      timespec spent{};
      ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &spent);
      char line[64];
      const int size = std::snprintf(line, sizeof line, "{\"processor_seconds\": %lld.%06ld}\n",
                                     static_cast<long long>(spent.tv_sec), spent.tv_nsec / 1000);
      // Writes the line with one system call and not through a stream: a child of this process may hold the stream's
      // lock.
      if (::write(STDERR_FILENO, line, static_cast<std::size_t>(size)) < 0 && errno != EINTR) return;
    }
  });
}

Heartbeat::~Heartbeat() {
  beating_->thread.request_stop();
  beating_->changed.notify_all();
}

void become_worker(std::int64_t memory_limit_mb, bool yields, int parent) {
  if (parent > 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) std::_Exit(3);  // the parent ended before prctl was called
  }
  if (yields) {
    const sched_param none{};
    if (::sched_setscheduler(0, SCHED_IDLE, &none) != 0) ::setpriority(PRIO_PROCESS, 0, 19);
  }
  if (memory_limit_mb > 0) {
    const rlim_t bytes = static_cast<rlim_t>(memory_limit_mb) << 20;
    const rlimit limit{bytes, bytes};
    if (::setrlimit(RLIMIT_AS, &limit) != 0)
      throw Error("the memory limit cannot be set", std::to_string(memory_limit_mb) + " MB", std::strerror(errno));
  }
}

}  // namespace limber
