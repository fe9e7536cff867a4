// SPDX-License-Identifier: AGPL-3.0-or-later
// Starts another program. Safe with any number of threads: nothing of this process runs in the new one before exec.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

#include "core/base/file.h"

namespace limber {

// Its standard streams, open files of this process; -1: /dev/null.
struct Streams {
  int in = -1, out = -1, err = -1;
};
enum class Environment { Same, Empty };

// Leads a process group of its own, so that a key at the terminal does not reach it and its own children end with it.
// Gets no signal blocked, and SIGINT, SIGTERM, SIGPIPE and SIGHUP as usual.
//   words    its arguments, its name first
//   what     what is started, for the message: "a worker"
//   returns  its process, which the caller must wait for          throws Error when it cannot be started
pid_t spawn(const Path& program, std::vector<std::string> words, const Streams& streams, Environment environment,
            const std::string& what);

}  // namespace limber
