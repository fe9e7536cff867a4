// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the files that belong to the program: themes, key maps, icons, samples and rig templates. They lie in the
// program's installation (share/limber) or in the source tree.
#pragma once

#include <string>

#include "core/base/file.h"

namespace limber {

// Returns the path of an asset. Throws Error when the file does not exist: the installation is incomplete.
Path asset(const std::string& name);  // name as in "themes/dark.json"

}  // namespace limber
