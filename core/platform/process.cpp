// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/process.h"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <ctime>

#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace limber {

namespace {
// Nice values of a background thread and of a worker process (0: normal, 19: lowest priority).
constexpr int kYielding = 10, kLowest = 19;

double seconds_of(clockid_t clock) {
  timespec spent{};
  ::clock_gettime(clock, &spent);
  return static_cast<double>(spent.tv_sec) + 1e-9 * static_cast<double>(spent.tv_nsec);
}

rusage usage_of(int who) {
  rusage usage{};
  ::getrusage(who, &usage);
  return usage;
}
}  // namespace

std::int64_t process_id() { return ::getpid(); }

bool end_with_parent(std::int64_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  return ::getppid() == parent;  // false: the parent ended before prctl() was called
}

void close_inherited_files() { ::closefrom(STDERR_FILENO + 1); }

void yield_to_other_programs() {
  const sched_param none{};
  if (::sched_setscheduler(0, SCHED_IDLE, &none) != 0) ::setpriority(PRIO_PROCESS, 0, kLowest);
}

// On Linux, setpriority() with 0 sets the priority of the calling thread only.
void lower_priority_of_thread() { ::setpriority(PRIO_PROCESS, 0, kYielding); }

std::error_code limit_memory(std::int64_t bytes) {
  const rlimit limit{static_cast<rlim_t>(bytes), static_cast<rlim_t>(bytes)};
  return ::setrlimit(RLIMIT_AS, &limit) == 0 ? std::error_code() : std::error_code(errno, std::generic_category());
}

double own_cpu_seconds() { return seconds_of(CLOCK_PROCESS_CPUTIME_ID); }
double thread_cpu_seconds() { return seconds_of(CLOCK_THREAD_CPUTIME_ID); }

double children_cpu_seconds() {
  const rusage usage = usage_of(RUSAGE_CHILDREN);
  const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::int64_t peak_memory() {
  return std::int64_t{usage_of(RUSAGE_SELF).ru_maxrss} * 1024;  // Linux gives ru_maxrss in units of 1024 bytes
}

std::size_t mapped_memory() {
  unsigned long pages = 0;
  if (FILE* file = std::fopen("/proc/self/statm", "re")) {
    if (std::fscanf(file, "%lu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace limber
