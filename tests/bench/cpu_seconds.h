// SPDX-License-Identifier: AGPL-3.0-or-later
// Returns the CPU time (user and system) of this process and of its child processes that have ended, in seconds.
#pragma once

#include <sys/resource.h>

namespace limber::bench {

inline double cpu_seconds() {
  double sum = 0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage used;
    getrusage(who, &used);
    for (const timeval& time : {used.ru_utime, used.ru_stime}) sum += double(time.tv_sec) + 1e-6 * double(time.tv_usec);
  }
  return sum;
}

}  // namespace limber::bench
