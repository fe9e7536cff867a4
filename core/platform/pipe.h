// SPDX-License-Identifier: AGPL-3.0-or-later
// Channels between this process and a program that it starts (child_program.h).
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string_view>
#include <system_error>

#include "core/platform/open_file.h"

namespace limber {

// A pipe from another program to this one. Reading does not block.
struct Pipe {
  Handle read_end, write_end;
};
// Creates a pipe.
//   buffer_bytes  size of the pipe's buffer, which the system may refuse; 0: the default size
Pipe make_pipe(std::error_code& error, int buffer_bytes = 0);

// A channel to another program, through which open files can be sent. `ours` is this program's end and does not block;
// `its` is the other program's end.
struct FileChannel {
  Handle ours, its;
};
FileChannel make_file_channel(std::error_code& error);

// Reads some of the available bytes. Returns their number; 0 at the end of the stream; -1 when no byte is available
// yet.
std::ptrdiff_t read_some(const Handle& from, void* to, std::size_t size);
// Sends some of the bytes through a FileChannel; sends `file` together with the first byte unless it is nullptr.
// Returns the number of sent bytes; 0 when the other end is closed; -1 when the channel's buffer is full.
std::ptrdiff_t send_some(const Handle& to, std::string_view bytes, const OpenFile* file);

// wait_to_read() waits until one of `ends` can be read; a closed end never can. wait_to_write() waits until `end` can
// be written to. Both functions return false after a wait of `milliseconds` without success.
bool wait_to_read(std::initializer_list<const Handle*> ends, int milliseconds);
bool wait_to_write(const Handle& end, int milliseconds);

// Functions for a program that another program has started, with a FileChannel as its standard input and a Pipe as its
// standard output. Both functions block. They return false when the other program has closed the channel.
bool write_to_parent(std::string_view head, std::string_view body);
// Reads `size` bytes. Unless `file` is nullptr, also receives the file that was sent with the first of these bytes.
// Returns false when the other program has closed the channel.
bool read_from_parent(void* to, std::size_t size, OpenFile* file);

}  // namespace limber
