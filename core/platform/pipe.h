// SPDX-License-Identifier: AGPL-3.0-or-later
// Channels between this process and a program that it starts (child_program.h).
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string_view>
#include <system_error>

#include "core/platform/open_file.h"

namespace limber {

// A pipe from another program to this one. Reading never waits.
struct Pipe {
  Handle read_end, write_end;
};
//   buffer_bytes  size of the pipe's buffer, which the system may refuse; 0: the usual size
Pipe make_pipe(std::error_code& error, int buffer_bytes = 0);

// A channel to another program, through which open files can be sent. `ours` is this program's end and never waits.
struct FileChannel {
  Handle ours, its;
};
FileChannel make_file_channel(std::error_code& error);

// Reads some of the bytes that are there. Returns their number; 0 at the end of the stream; -1 when none is there yet.
std::ptrdiff_t read_some(const Handle& from, void* to, std::size_t size);
// Sends some of the bytes through a FileChannel, with the first byte also `file`, unless it is nullptr. Returns the
// number of bytes; 0 when nobody reads the channel any more; -1 when it has no room now.
std::ptrdiff_t send_some(const Handle& to, std::string_view bytes, const OpenFile* file);

// Wait until one of the ends can be read (closed ones: never), or the end can be written to. Return false when
// `milliseconds` have passed without that.
bool wait_to_read(std::initializer_list<const Handle*> ends, int milliseconds);
bool wait_to_write(const Handle& end, int milliseconds);

// The other side of the two channels, in a program whose standard input is a FileChannel and whose standard output is a
// pipe. Both functions wait. They return false when the program at the other end has closed the channel.
bool write_to_parent(std::string_view head, std::string_view body);
// Reads `size` bytes, and into `file`, unless it is nullptr, the file that was sent with the first of them.
bool read_from_parent(void* to, std::size_t size, OpenFile* file);

}  // namespace limber
