// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads bytes at an offset of an open file, all of them or none.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>

#include <unistd.h>

namespace limber {

// Reads `size` bytes that begin at `offset`. Returns false where the file ends before them or cannot be read.
//   to  room for `size` bytes
inline bool read_at(int descriptor, std::int64_t offset, char* to, std::size_t size) {
  while (size > 0) {
    const ssize_t got = ::pread(descriptor, to, size, offset);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    to += got;
    offset += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

}  // namespace limber
