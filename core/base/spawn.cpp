// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/spawn.h"

#include <csignal>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include "core/base/error.h"

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

  void place(int from, int to) {
    if (from >= 0) posix_spawn_file_actions_adddup2(&files, from, to);
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
}  // namespace

pid_t spawn(const Path& program, std::vector<std::string> words, const Streams& streams, Environment environment,
            const std::string& what) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  Settings settings;
  settings.place(streams.in, STDIN_FILENO);
  settings.place(streams.out, STDOUT_FILENO);
  settings.place(streams.err, STDERR_FILENO);
  settings.set_signals_and_group();
  pid_t process = -1;
  // LD_LIBRARY_PATH is passed on even when the environment is otherwise empty, so that the new program finds the same
  // libraries.
  std::string libraries = "LD_LIBRARY_PATH=";
  const char* said = std::getenv("LD_LIBRARY_PATH");
  if (said) libraries += said;
  char* nothing[] = {said ? libraries.data() : nullptr, nullptr};
  const int failure = ::posix_spawn(&process, program.c_str(), &settings.files, &settings.attributes, argv.data(),
                                    environment == Environment::Same ? environ : nothing);
  if (failure != 0) throw Error(what + " cannot be started", program.string(), std::strerror(failure));
  return process;
}

}  // namespace limber
