// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/child_process.h"

#include <cerrno>
#include <csignal>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace limber {

namespace {

constexpr rlim_t kProcessorSeconds = 20;

void become_harmless() {
  for (int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGINT, SIGTERM}) ::signal(signal, SIG_DFL);
  const rlimit seconds{kProcessorSeconds, kProcessorSeconds}, no_core{0, 0};
  ::setrlimit(RLIMIT_CPU, &seconds);
  ::setrlimit(RLIMIT_CORE, &no_core);
  const int nowhere = ::open("/dev/null", O_WRONLY);
  if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
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

// Up to one byte more than `most`.
std::string read_all(int from, std::size_t most) {
  std::string bytes;
  char block[1 << 16];
  while (bytes.size() <= most) {
    const ssize_t done = ::read(from, block, sizeof block);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) break;
    bytes.append(block, static_cast<std::size_t>(done));
  }
  return bytes;
}

}  // namespace

std::optional<std::string> run_in_child(const std::function<bool(const Send&)>& work, std::size_t most) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return std::nullopt;
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    become_harmless();
    bool done = false;
    try {
      done = work([&](const void* bytes, std::size_t size) { write_all(ends[1], bytes, size); });
    } catch (...) {
    }
    ::_exit(done ? 0 : 1);
  }
  ::close(ends[1]);
  std::string sent = child > 0 ? read_all(ends[0], most) : std::string();
  ::close(ends[0]);  // a child that sends too much ends here
  if (child < 0) return std::nullopt;
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || sent.size() > most) return std::nullopt;
  return sent;
}

}  // namespace limber
