// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/terminal.h"

#include <cerrno>

#include <fcntl.h>
#include <unistd.h>

namespace limber {

bool error_stream_is_terminal() { return ::isatty(STDERR_FILENO) != 0; }

bool write_error_stream(std::string_view text) {
  return ::write(STDERR_FILENO, text.data(), text.size()) >= 0 || errno == EINTR;
}

void keep_standard_streams() {
  // open() returns the lowest free descriptor, so it takes the place of the missing stream. The stream is read-only, so
  // that writing to it fails and the failure is reported.
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream)
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", O_RDONLY);
}

}  // namespace limber
