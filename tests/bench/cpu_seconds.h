// SPDX-License-Identifier: AGPL-3.0-or-later
// CPU time, user and system, of this process and of those it has started and seen end; s.
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
