// SPDX-License-Identifier: AGPL-3.0-or-later
// The standard streams of this process.
#pragma once

#include <string_view>

namespace limber {

// Returns true if the error stream is shown on a terminal.
bool error_stream_is_terminal();

// Writes text to the error stream by one system call instead of stdio, whose lock a forked child may hold. Returns
// false when nobody reads the stream any more.
bool write_error_stream(std::string_view text);

// Opens a read-only stream for each of stdin, stdout and stderr that is missing when the program starts. Otherwise the
// next file that is opened would get the missing stream's descriptor and receive the program's messages.
void keep_standard_streams();

}  // namespace limber
