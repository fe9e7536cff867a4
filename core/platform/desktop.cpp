// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/desktop.h"

#include <cstdlib>
#include <string>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/platform/module.h"

extern char** environ;

namespace limber {

namespace {
// Returns the path that an environment variable names; empty when the path is not absolute.
Path path_in(const char* variable) {
  const char* value = std::getenv(variable);
  return value && *value == '/' ? Path(value) : Path();
}
}  // namespace

Path user_folder(UserFolder kind) {
  struct Place {
    const char *variable, *below_home;
  };
  constexpr Place kPlaces[] = {
      {"XDG_CONFIG_HOME", ".config"}, {"XDG_CACHE_HOME", ".cache"}, {"XDG_STATE_HOME", ".local/state"}};
  const Place& place = kPlaces[static_cast<int>(kind)];
  if (Path set = path_in(place.variable); !set.empty()) return set;
  const Path home = path_in("HOME");
  return home.empty() ? Path() : home / place.below_home;
}

Path home_folder() {
  const Path home = path_in("HOME");
  return home.empty() ? Path("/") : home;
}

std::vector<Path> mounted_folders() {
  std::vector<Path> folders;
  const char* user = std::getenv("USER");
  for (const Path& base : {user ? Path("/media") / user : Path("/media"),
                           user ? Path("/run/media") / user : Path("/run/media"), Path("/mnt")}) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(base, error))
      if (entry.is_directory(error)) folders.push_back(entry.path());
  }
  return folders;
}

// Starts the program by a shell that exits at once, so that the program is no child of this process. Returns false if
// it cannot be started.
bool open_in_default_program(const Path& path) {
  const auto opener = find_program("xdg-open");
  if (!opener) return false;
  std::string program = "sh", option = "-c", script = "\"$0\" \"$1\" </dev/null >/dev/null 2>&1 &",
              runs = opener->string(), name = std::filesystem::absolute(path).string();
  char* arguments[] = {program.data(), option.data(), script.data(), runs.data(), name.data(), nullptr};
  pid_t shell = 0;
  int status = 1;
  return ::posix_spawn(&shell, "/bin/sh", nullptr, nullptr, arguments, environ) == 0 &&
         ::waitpid(shell, &status, 0) == shell && status == 0;
}

}  // namespace limber
