// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/replaced_file.h"

#include <sys/stat.h>
#include <unistd.h>

namespace limber {

namespace fs = std::filesystem;

Path target_of(const Path& path) {
  constexpr int kMostLinks = 40;
  Path target = path;
  std::error_code error;
  for (int links = 0; fs::is_symlink(target, error); ++links) {
    if (links == kMostLinks)
      throw Error("the links go round in a circle", path.string(), "remove them, or write elsewhere");
    const Path next = fs::read_symlink(target, error);
    if (error) throw Error("the link cannot be read", target.string(), error.message());
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  if (fs::exists(target, error) && !fs::is_regular_file(target, error) && !fs::is_directory(target, error))
    throw Error("what is there is no regular file", path.string(), "name a file on disk");
  return target;
}

void take_permissions(int descriptor, const Path& replaced) {
  struct stat status {};
  if (::stat(replaced.c_str(), &status) != 0) return;
  // The owner is set before the permissions, because a change of owner clears some permissions. Only root may set the
  // owner; a process of another user sets only the group.
  if (::fchown(descriptor, status.st_uid, status.st_gid) != 0 &&
      ::fchown(descriptor, static_cast<uid_t>(-1), status.st_gid) != 0)
    status.st_mode &= ~static_cast<mode_t>(S_ISUID | S_ISGID);
  // On a file system without permissions fchmod() fails. Then the file keeps the restrictive permissions that it was
  // opened with.
  [[maybe_unused]] const int refused = ::fchmod(descriptor, status.st_mode & 07777);
}

Error with_name(const Error& error, const Path& temporary, const Path& name) {
  std::string message = error.what();
  const std::size_t at = message.find(temporary.string());
  if (at == std::string::npos) return error;
  message.replace(at, temporary.string().size(), name.string());
  const std::size_t first = message.find(": "), last = message.rfind(": ");
  if (first >= last) return {message, name.string(), "check permissions and free space"};
  return {message.substr(0, first), message.substr(first + 2, last - first - 2), message.substr(last + 2)};
}

}  // namespace limber
