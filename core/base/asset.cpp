// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/asset.h"

#include <filesystem>

#include "core/base/error.h"

namespace limber {

namespace fs = std::filesystem;

Path asset(const std::string& name) {
  std::error_code failed;
  const Path program = fs::read_symlink("/proc/self/exe", failed);
  // Searches the installation of the running program, then the source tree, then the folder where Limber was installed.
  // The last folder serves another program that uses Limber as a library.
  for (const Path& folder : {program.parent_path().parent_path() / "share/limber", Path(LIMBER_SOURCE_ASSETS),
                             Path(LIMBER_INSTALLED_IN) / "share/limber"})
    if (fs::exists(folder / name, failed)) return folder / name;
  throw Error("a file of the program itself is missing", name, "install Limber again");
}

}  // namespace limber
