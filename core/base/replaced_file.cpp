// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/replaced_file.h"

namespace limber {

namespace fs = std::filesystem;

Path target_of(const Path& path) {
  constexpr int kMostLinks = 40;
  Path target = path;
  std::error_code error;
  for (int links = 0; fs::is_symlink(target, error); ++links) {
    if (links == kMostLinks)
      throw Error("the links form a cycle", path.string(), "remove the links, or write elsewhere");
    const Path next = fs::read_symlink(target, error);
    if (error) throw Error("the link cannot be read", target.string(), error.message());
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  if (fs::exists(target, error) && !fs::is_regular_file(target, error) && !fs::is_directory(target, error))
    throw Error("this is not a regular file", path.string(), "name a file on disk");
  return target;
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
