// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/child_process.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/platform/process.h"

namespace limber {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kAskMilliseconds = 20;  // interval between two checks for whether the user cancelled

rlim_t whole_seconds(double seconds) { return static_cast<rlim_t>(std::clamp(std::ceil(seconds), 1.0, 1e9)); }

void become_harmless(const ChildLimits& limits, std::size_t memory, pid_t parent) {
  if (!end_with_parent(parent)) ::_exit(1);
  for (int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGINT, SIGTERM, SIGXCPU}) ::signal(signal, SIG_DFL);
  const rlim_t most = whole_seconds(limits.processor_seconds);
  const rlimit seconds{most, most + 1}, no_core{0, 0}, space{memory, memory};
  ::setrlimit(RLIMIT_CPU, &seconds);
  ::setrlimit(RLIMIT_CORE, &no_core);
  if (memory > 0) ::setrlimit(RLIMIT_AS, &space);
  const int nowhere = ::open("/dev/null", O_WRONLY);
  if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO), ::dup2(nowhere, STDOUT_FILENO);
}

void write_all(int to, const void* bytes, std::size_t size) {
  const char* from = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t done = ::write(to, from, size);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) ::_exit(1);
    from += done;
    size -= static_cast<std::size_t>(done);
  }
}

enum class Ending { closed, too_much, too_late, cancelled };

// Reads from the pipe into `bytes`. Ends when the pipe closes, more than `most` bytes have arrived, the time `latest`
// is reached or the user cancels. `bytes` may exceed `most` by one block.
Ending read_all(int from, std::size_t most, Clock::time_point latest, const AskCancelled& cancelled,
                std::string& bytes) {
  char block[1 << 16];
  while (bytes.size() <= most) {
    if (cancelled && cancelled()) return Ending::cancelled;
    if (Clock::now() >= latest) return Ending::too_late;
    pollfd ready{from, POLLIN, 0};
    const int events = ::poll(&ready, 1, kAskMilliseconds);
    if (events == 0 || (events < 0 && errno == EINTR)) continue;
    const ssize_t done = ::read(from, block, sizeof block);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return Ending::closed;
    bytes.append(block, static_cast<std::size_t>(done));
  }
  return Ending::too_much;
}

// Waits for the child process and returns its exit status. If the child has closed its end of the pipe but does not end
// by the time `latest`, or the user cancels, the child is killed.
int status_of(pid_t child, Clock::time_point latest, const AskCancelled& cancelled, Ending& ending) {
  int status = 0;
  while (ending == Ending::closed) {
    const pid_t ended = ::waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (Clock::now() >= latest) ending = Ending::too_late;
    else if (cancelled && cancelled()) ending = Ending::cancelled;
    else ::usleep(1000);
  }
  ::kill(child, SIGKILL);
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

Clock::time_point after(double seconds) {
  constexpr double kForever = 1e8;
  return Clock::now() +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(seconds, kForever)));
}

std::string failure_of(Ending ending, int status) {
  if (ending == Ending::too_much) return "the process sent more than expected";
  if (ending == Ending::too_late) return "the process took too long";
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) return "the process took too much processor time";
  if (WIFSIGNALED(status)) return "the process crashed (signal " + std::to_string(WTERMSIG(status)) + ")";
  if (WIFEXITED(status) && WEXITSTATUS(status) != 0)
    return "the process failed (exit code " + std::to_string(WEXITSTATUS(status)) + ")";
  return {};
}

}  // namespace

ChildAnswer run_in_child(const std::function<bool(const Send&)>& work, std::size_t most, const ChildLimits& limits,
                         const AskCancelled& cancelled) {
  constexpr const char* kNoProcess = "no process could be started";
  const std::size_t memory = limits.memory_bytes > 0 ? mapped_memory() + limits.memory_bytes : 0;
  const Clock::time_point latest = after(limits.seconds);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return {std::nullopt, kNoProcess};
  const pid_t parent = ::getpid(), child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    become_harmless(limits, memory, parent);
    bool done = false;
    try {
      done = work([&](const void* bytes, std::size_t size) { write_all(ends[1], bytes, size); });
    } catch (...) {
    }
    ::_exit(done ? 0 : 1);
  }
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    return {std::nullopt, kNoProcess};
  }
  std::string sent;
  Ending ending = read_all(ends[0], most, latest, cancelled, sent);
  ::close(ends[0]);
  const int status = status_of(child, latest, cancelled, ending);
  if (ending == Ending::cancelled) return {.failure = "the process was cancelled", .cancelled = true};
  if (std::string failure = failure_of(ending, status); !failure.empty()) return {std::nullopt, std::move(failure)};
  return {std::move(sent), {}};
}

std::optional<std::string> run_in_child(const std::function<bool(const Send&)>& work, std::size_t most) {
  return run_in_child(work, most, ChildLimits{}).sent;
}

}  // namespace limber
