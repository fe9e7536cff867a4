// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the files that come with the program: themes, key maps, icons, samples and rig templates. They lie in the
// program's installation (share/limber) or in the source tree.
#pragma once

#include <optional>
#include <string>

#include "core/base/file.h"

namespace limber {

// Returns the path of one of the program's own files. Throws Error when the file does not exist, because the
// installation is incomplete.
Path asset(const std::string& name);  // `name` is relative, as in "themes/dark.json"
// Returns the path of one of the program's own files, or nothing when the file does not exist.
std::optional<Path> find_asset(const std::string& name);

}  // namespace limber
