// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/asset.h"

#include <filesystem>
#include <vector>

#include "core/base/error.h"
#include "core/platform/module.h"

namespace limber {

namespace fs = std::filesystem;

std::optional<Path> find_asset(const std::string& name) {
  std::error_code failed;
  const Path program = running_program_path();
  // Searches beside the shared object that contains this code, in the installation of the running program, in the
  // source tree, then where Limber was installed. The last folder is for other programs that use Limber as a library.
  std::vector<Path> folders = {program.parent_path().parent_path() / "share/limber", Path(LIMBER_SOURCE_ASSETS),
                               Path(LIMBER_INSTALLED_IN) / "share/limber"};
  if (const Path own = own_shared_object(); !own.empty()) folders.insert(folders.begin(), own.parent_path() / "assets");
  for (const Path& folder : folders)
    if (fs::exists(folder / name, failed)) return folder / name;
  return std::nullopt;
}

Path asset(const std::string& name) {
  if (const auto found = find_asset(name)) return *found;
  throw Error("a file of the program itself is missing", name, "install Limber again");
}

}  // namespace limber
