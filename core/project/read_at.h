// SPDX-License-Identifier: AGPL-3.0-or-later
// Bytes from a place of an open file, whole or not at all.
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>

#include <unistd.h>

namespace limber {

// False where the file ends before, or cannot be read there.
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
