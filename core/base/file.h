// SPDX-License-Identifier: AGPL-3.0-or-later
// Files whole or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace limber {

using Path = std::filesystem::path;

// The file's bytes. Throws Error when it cannot be read or is larger than `limit` bytes.
std::string read_file(const Path& path, std::uint64_t limit = std::uint64_t{1} << 32);

// Writes under a temporary name in the same folder (same extension), flushes, and renames over `path`: whoever looks
// sees the old file or the new one. When `write` throws, the temporary file is gone and `path` is as before.
//   write  gets the temporary path and must create that file
void write_atomically(const Path& path, const std::function<void(const Path& temporary)>& write);
void write_file_atomically(const Path& path, const std::string& bytes);

// Lower-case hexadecimal SHA-256 of a file's bytes; of a folder, of its files' hashes in name order.
std::string sha256_of_file(const Path& path);
std::string sha256_of_bytes(const void* bytes, std::size_t size);

}  // namespace limber
