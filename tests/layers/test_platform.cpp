// SPDX-License-Identifier: AGPL-3.0-or-later
// Checks that code for one operating system is only in core/platform. platform.h says what other systems would need.
#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/layers/sources.h"

using namespace limber::layers;

namespace {

constexpr const char* kRoom = "core/platform/";

std::vector<std::string> files_outside() {
  std::vector<std::string> files;
  for (const fs::path& file : sources({"core", "render", "editor"}))
    if (!file.generic_string().starts_with(kRoom)) files.push_back(file.generic_string());
  return files;
}

// Checks that no code outside core/platform matches the pattern. Comments are ignored.
void check_none(const std::string& pattern) {
  static const std::regex comment(R"((^|\s)//.*)");
  const std::regex forbidden(pattern);
  for (const std::string& file : files_outside())
    for (const std::string& line : lines_of(file)) {
      if (!std::regex_search(line, forbidden)) continue;
      INFO(file, ": ", line);
      CHECK_FALSE(std::regex_search(std::regex_replace(line, comment, ""), forbidden));
    }
}

}  // namespace

TEST_CASE("platform: headers that only some systems have are included only in core/platform") {
  static const std::regex header(
      R"(^(unistd|fcntl|dirent|dlfcn|signal|spawn|poll|sched|malloc|termios|pthread|pwd|grp|netdb|semaphore|strings|)"
      R"(libgen|ftw|glob|execinfo|link|sys/.*|linux/.*|net/.*|netinet/.*|arpa/.*|mach/.*|windows|io|process)\.h$)");
  for (const std::string& file : files_outside())
    for (const Include& include : includes_of(file)) {
      INFO(file, " includes ", include.header);
      CHECK_FALSE(std::regex_match(include.header, header));
    }
}

TEST_CASE("platform: functions, signals and handles of the system are used only in core/platform") {
  check_none(R"((^|[^\w>)])::[a-z_]+\()");
  check_none(
      R"(\b(fork|vfork|execv|mmap|munmap|madvise|getpid|getppid|geteuid|isatty|waitpid|waitid|usleep|sysconf|prctl|)"
      R"(setrlimit|getrlimit|getrusage|setpriority|localtime_r|gmtime_r|mkdtemp|mkstemp|strsignal|dlsym|dladdr|)"
      R"(posix_\w+|flock|fsync|fdatasync|pwrite|pread|readlink|realpath|setenv|unsetenv|gethostname|uname|fcntl|)"
      R"(ioctl|lstat|fstat|fchmod|chmod|fchown|ftruncate|linkat|closefrom|clock_gettime|malloc_trim|mallopt|)"
      R"(sigaction|sigemptyset|syscall)\()");
  check_none(R"(\bSIG(?!INT\b|TERM\b|GRAPH)[A-Z]{3,}\b)");  // SIGINT and SIGTERM are standard C++
  check_none(R"(\b(pid_t|off_t|mode_t|uid_t|gid_t)\b|(^|[^:\w])ssize_t\b)");
  check_none(R"(\b(handle\(\)|read_end|write_end|ours|its)\.native\()");
}

TEST_CASE("platform: paths and variables of one system are named only in core/platform") {
  check_none(R"~("/(proc|dev|sys|bin|etc|run|mnt|media|tmp)\b|"(HOME|USER|PATH|XDG_\w+)")~");
}

TEST_CASE("platform: its page says of each file what other systems would need") {
  const std::vector<std::string> page = lines_of("core/platform/platform.h");
  for (const fs::path& file : sources({"core/platform"})) {
    const std::string name = file.stem().string();
    if (name == "platform") continue;
    INFO(name);
    CHECK(std::any_of(page.begin(), page.end(),
                      [&](const auto& line) { return line.starts_with("//   " + name + " "); }));
  }
}
