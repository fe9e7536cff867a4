// SPDX-License-Identifier: AGPL-3.0-or-later
// Starts another program. This is safe while other threads run, because no code of this process runs in the new process
// before exec.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

#include "core/base/file.h"

namespace limber {

// The new program's standard streams, as file descriptors of this process; -1: /dev/null.
struct Streams {
  int in = -1, out = -1, err = -1;
};
enum class Environment { Same, Empty };

// Starts the program as the leader of its own process group. So Ctrl+C at the terminal does not reach the program, and
// its children can be ended together with it. The program starts with no signal blocked, and with the default actions
// of SIGINT, SIGTERM, SIGPIPE and SIGHUP.
//   words    arguments, the program's name first
//   what     what is started, for the error message: "a worker"
//   returns  the process, which the caller must wait for
//   throws Error when the program cannot be started
pid_t spawn(const Path& program, std::vector<std::string> words, const Streams& streams, Environment environment,
            const std::string& what);

}  // namespace limber
