// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/child_program.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <thread>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace limber {

namespace {
// Owns the two structures that posix_spawn() takes: file actions and attributes.
struct Settings {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;

  Settings() {
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
  }
  ~Settings() {
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
  }
  Settings(const Settings&) = delete;
  Settings& operator=(const Settings&) = delete;

  void place(const Handle* from, int to) {
    if (from) posix_spawn_file_actions_adddup2(&files, from->native(), to);
    else posix_spawn_file_actions_addopen(&files, to, "/dev/null", O_RDWR, 0);
  }
  void set_signals_and_group() {
    sigset_t none, defaults;
    sigemptyset(&none);
    sigemptyset(&defaults);
    for (int signal : {SIGINT, SIGTERM, SIGPIPE, SIGHUP}) sigaddset(&defaults, signal);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
};

// Waits for the end of a process and returns its status.
int wait_for(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}
}  // namespace

bool ProgramEnd::was_killed() const { return signal == SIGKILL; }
bool ProgramEnd::took_too_much_time() const { return signal == SIGXCPU; }
std::string ProgramEnd::signal_text() const { return ::strsignal(signal); }

ChildProgram::ChildProgram(const Path& program, std::vector<std::string> words, const Streams& streams,
                           Environment environment, std::error_code& error) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  Settings settings;
  settings.place(streams.in, STDIN_FILENO);
  settings.place(streams.out, STDOUT_FILENO);
  settings.place(streams.err, STDERR_FILENO);
  settings.set_signals_and_group();
  // LD_LIBRARY_PATH is passed on even when the environment is otherwise empty, so that the new program finds the same
  // libraries.
  std::string libraries = "LD_LIBRARY_PATH=";
  const char* said = std::getenv("LD_LIBRARY_PATH");
  if (said) libraries += said;
  char* nothing[] = {said ? libraries.data() : nullptr, nullptr};
  pid_t process = -1;
  const int failure = ::posix_spawn(&process, program.c_str(), &settings.files, &settings.attributes, argv.data(),
                                    environment == Environment::Same ? environ : nothing);
  error = {failure, std::generic_category()};
  ended_ = failure != 0;
  if (!ended_) id_ = process;
}

ChildProgram::~ChildProgram() {
  if (ended_) return;
  kill();
  try {
    std::thread(wait_for, static_cast<pid_t>(id_)).detach();
  } catch (const std::system_error&) {
    wait_for(static_cast<pid_t>(id_));
  }
}

// Sends the signal to the whole process group, which a negative id selects.
void ChildProgram::ask_to_end() const {
  if (!ended_) ::kill(static_cast<pid_t>(-id_), SIGTERM);
}
void ChildProgram::kill() const {
  if (!ended_) ::kill(static_cast<pid_t>(-id_), SIGKILL);
}

void ChildProgram::kill_and_wait() {
  if (ended_) return;
  kill();
  bury();
}

bool ChildProgram::has_ended() {
  siginfo_t info{};
  if (ended_ || ::waitid(P_PID, static_cast<id_t>(id_), &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid != id_)
    return ended_;
  kill();
  bury();
  return true;
}

void ChildProgram::bury() {
  const int status = wait_for(static_cast<pid_t>(id_));
  ended_ = true;
  if (WIFSIGNALED(status)) end_.signal = WTERMSIG(status);
  else end_.exit_code = WEXITSTATUS(status);
}

double ChildProgram::processor_seconds() const {
  clockid_t clock;
  timespec time{};
  if (ended_ || ::clock_getcpuclockid(static_cast<pid_t>(id_), &clock) != 0 || ::clock_gettime(clock, &time) != 0)
    return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace limber
