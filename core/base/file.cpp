// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/file.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "core/base/error.h"
#include "core/base/leftovers.h"
#include "core/base/replaced_file.h"
#include "core/platform/memory_pages.h"
#include "core/platform/open_file.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
Error not_written(const Path& path, const std::error_code& error) {
  return {"the file cannot be written", path.string(),
          is_disk_full(error) ? "the disk is full: free some space, or write elsewhere" : error.message()};
}
}  // namespace

std::string read_file(const Path& path, std::uint64_t limit) {
  std::error_code error;
  if (fs::is_directory(path, error)) throw Error("this is a folder", path.string(), "name a file");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error("the file cannot be opened", path.string(), std::strerror(errno));
  const std::uint64_t size = fs::file_size(path, error);
  if (error) throw Error("this is not a regular file", path.string(), "name a file on disk");
  if (size > limit)
    throw Error("the file has " + std::to_string(size) + " bytes", path.string(),
                "files of this kind may have " + std::to_string(limit) + " bytes at most");
  std::string bytes;
  bytes.reserve(size);
  want_large_pages(bytes.data(), static_cast<std::int64_t>(size));
  bytes.resize(size);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw Error("the file cannot be read to its end", path.string(), "check the disk and try again");
  return bytes;
}

void check_place(const Path& path) {
  std::error_code error;
  if (path.string().find('\0') != std::string::npos)
    throw Error("the name contains a zero byte, where the system would cut the name off", path.string().c_str(),
                "choose another name");
  const Path folder = path.has_parent_path() ? path.parent_path() : Path(".");
  if (!fs::is_directory(folder, error))
    throw Error("the folder does not exist", folder.string(), "make it first, or write elsewhere");
  if (fs::is_directory(path, error))
    throw Error("a folder has this name already", path.string(), "choose another name");
}

namespace {

// Fills a new file. Calls `write`, which writes to the file through the path `temporary`. Then gives the file the
// permissions of `target`, the file that it will replace, and flushes it to disk.
void fill(OpenFile& file, const Path& temporary, const Path& target, const Path& path,
          const std::function<void(const Path&)>& write) {
  try {
    write(temporary);
  } catch (const Error& error) {
    throw with_name(error, temporary, path);
  }
  file.take_permissions(target);
  if (const std::error_code error = file.flush()) throw not_written(path, error);
}

void rename_to(const Path& target, const Path& temporary, const Path& path) {
  std::error_code error;
  fs::rename(temporary, target, error);
  if (error) throw not_written(path, error);
}

}  // namespace

void write_atomically(const Path& path, const std::function<void(const Path&)>& write) {
  check_place(path);
  const Path target = target_of(path);
  check_place(target);
  const Path folder = target.has_parent_path() ? target.parent_path() : Path(".");
  const Path name = temporary_name(target);
  // A file that will replace another one is private at first. Else users who may not read the other file could read it.
  std::error_code error;
  const OpeningRules rules{.is_private = fs::exists(target, error)};
  if (OpenFile nameless = OpenFile::nameless(folder, rules); nameless.is_open()) {
    fill(nameless, nameless.path_while_open(), target, path, write);
    error = nameless.give_name(target);
    if (!error) return;
    if (error != std::errc::file_exists) throw not_written(path, error);
    // A nameless file cannot take the name of an existing file. So it first gets a temporary name and is then renamed.
    const Unfinished unfinished(name);
    error = nameless.give_name(name);
    if (error) throw not_written(path, error);
    return rename_to(target, name, path);
  }
  const Unfinished unfinished(name);
  OpenFile named(name, Opening::New, error, rules);
  if (error) throw not_written(path, error);
  fill(named, name, target, path, write);
  rename_to(target, name, path);
}

void write_file_atomically(const Path& path, const std::string& bytes) {
  write_atomically(path, [&](const Path& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.flush();
    if (!out) throw Error("the file cannot be written", path.string(), "check permissions and free space");
  });
}

}  // namespace limber
