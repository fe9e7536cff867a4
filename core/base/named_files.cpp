// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/named_files.h"

#include <map>
#include <optional>
#include <tuple>

#include "core/platform/file_system.h"

namespace limber {

namespace fs = std::filesystem;

namespace {
constexpr int kMostLinks = 40;  // at most this many symbolic links of a path are followed, as in the kernel

// Resolves the symbolic links of a path. The file that a link points to need not exist yet.
Path place_of(Path path) {
  std::error_code error;
  for (int i = 0; i < kMostLinks && fs::is_symlink(path, error); ++i)
    path = path.parent_path() / fs::read_symlink(path, error);
  return fs::weakly_canonical(path, error);
}

// Returns an identity that is equal for all names of one file: device and inode if the file exists, else the resolved
// path. Returns nothing for a device or a pipe, because writing to it destroys nothing.
using Identity = std::tuple<std::uint64_t, std::uint64_t, std::string>;
std::optional<Identity> identity_of(const Path& path) {
  const auto status = status_of_file(path);
  if (!status) return Identity{0, 0, place_of(path).string()};
  if (!status->is_folder && !status->is_regular) return std::nullopt;
  return Identity{status->device, status->number, ""};
}

using Known = std::map<Identity, NamedFile>;

// Returns the input files by their identities. For an input that is a folder, also adds the files in it.
Known identified(const std::vector<NamedFile>& inputs) {
  Known known;
  const auto add = [&](const NamedFile& file) {
    if (const auto identity = identity_of(file.path)) known.emplace(*identity, file);
  };
  for (const NamedFile& input : inputs) {
    add(input);
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(input.path, error)) add({input.named_by, entry.path()});
  }
  return known;
}

std::string told(const NamedFile& file) { return file.path.string() + " (" + file.named_by + ")"; }
}  // namespace

void check_apart(const std::vector<NamedFile>& inputs, const std::vector<NamedFile>& outputs) {
  const Known read = identified(inputs);
  Known written;
  for (const NamedFile& output : outputs) {
    const auto identity = identity_of(output.path);
    if (!identity) continue;
    if (const auto input = read.find(*identity); input != read.end())
      throw UsageError("the output is also an input", told(output) + " and " + told(input->second),
                       "give the output another name");
    if (const auto [other, is_new] = written.emplace(*identity, output); !is_new)
      throw UsageError("two outputs would be the same file", told(other->second) + " and " + told(output),
                       "give each output another name");
  }
}

}  // namespace limber
