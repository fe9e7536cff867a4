// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes whole files, and computes their hashes. A file is written completely or not at all.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "core/platform/path.h"

namespace limber {

// Returns the bytes of a file. Throws Error when the file cannot be read or is larger than `limit` bytes.
std::string read_file(const Path& path, std::uint64_t limit = std::uint64_t{1} << 32);

// Throws Error when no file can be written at `path`, because its folder is missing or `path` is itself a folder.
// Commands call this first, so that they fail before a long computation.
void check_place(const Path& path);

// Writes a file completely or not at all: fills a nameless file in the folder of `path`, flushes it to disk and gives
// it the name `path` in one step. Where the file system has no nameless files, the file has a temporary name until
// then. Readers see either the old file or the new one, and a killed process leaves nothing behind. When `write`
// throws, `path` is unchanged and the error names `path`. The new file gets the permissions of the file that it
// replaces. When `path` is a symbolic link, its target is replaced.
//   write  receives the path of the unfinished file, which it opens for writing; its extension has no meaning
void write_atomically(const Path& path, const std::function<void(const Path& temporary)>& write);
void write_file_atomically(const Path& path, const std::string& bytes);

// Returns the SHA-256 of a file's bytes in lower-case hexadecimal. For a folder, returns the SHA-256 of the hashes of
// its files, in the order of their names.
std::string sha256_of_file(const Path& path);
std::array<std::uint8_t, 32> sha256(const void* bytes, std::size_t size);
std::string sha256_of_bytes(const void* bytes, std::size_t size);

}  // namespace limber
