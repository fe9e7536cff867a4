// SPDX-License-Identifier: AGPL-3.0-or-later
// Files whole or not at all.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace limber {

using Path = std::filesystem::path;

// The file's bytes. Throws Error when it cannot be read or is larger than `limit` bytes.
std::string read_file(const Path& path, std::uint64_t limit = std::uint64_t{1} << 32);

// Throws Error when no file can be put there: the folder is missing, or a folder has that name. Commands ask this
// first, before they compute.
void check_place(const Path& path);

// Writes a file without a name in the same folder (where the file system has none of those: under a temporary name),
// flushes it, and gives it the name `path` in one step: whoever looks sees the old file or the new one, and a process
// that is killed leaves nothing behind. When `write` throws, `path` is as before, and the error names `path`. A file
// that is replaced keeps its permissions; a symbolic link stays, and the file that it names is replaced.
//   write  gets a path to open for writing (with no meaningful extension)
void write_atomically(const Path& path, const std::function<void(const Path& temporary)>& write);
void write_file_atomically(const Path& path, const std::string& bytes);

// Lower-case hexadecimal SHA-256 of a file's bytes; of a folder, of its files' hashes in name order.
std::string sha256_of_file(const Path& path);
std::array<std::uint8_t, 32> sha256(const void* bytes, std::size_t size);
std::string sha256_of_bytes(const void* bytes, std::size_t size);

}  // namespace limber
