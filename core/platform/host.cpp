// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/host.h"

#include <fstream>

#include <sys/utsname.h>
#include <unistd.h>

namespace limber {

SystemName system_name() {
  utsname system{};
  ::uname(&system);
  return {system.sysname, system.release, system.machine};
}

bool has_avx2() {
#ifdef __x86_64__
  static const bool has = __builtin_cpu_supports("avx2");
  return has;
#else
  return false;
#endif
}

std::string host_name() {
  char name[256] = {};
  ::gethostname(name, sizeof name - 1);
  return name;
}

std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name"))
      if (const auto colon = line.find(": "); colon != std::string::npos) return line.substr(colon + 2);
  return "unknown processor";
}

std::int64_t physical_memory() { return std::int64_t{::sysconf(_SC_PHYS_PAGES)} * ::sysconf(_SC_PAGESIZE); }

}  // namespace limber
