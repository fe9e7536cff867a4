// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/batch/machine.h"

#include <cmath>
#include <fstream>
#include <thread>

#include <sys/utsname.h>
#include <unistd.h>

namespace limber {

namespace {
std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name"))
      if (const auto colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
  return "unknown processor";
}
}  // namespace

std::string machine_text() {
  utsname system{};
  ::uname(&system);
  const double bytes = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE));
  const unsigned cores = std::thread::hardware_concurrency();
  return processor() + ", " + std::to_string(cores) + (cores == 1 ? " core, " : " cores, ") +
         std::to_string(std::lround(bytes / 1e9)) + " GB, " + system.sysname + " " + system.release;
}

}  // namespace limber
