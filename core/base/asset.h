// SPDX-License-Identifier: AGPL-3.0-or-later
// Where themes, key maps, icons, samples and rig templates lie: beside the installed program (share/limber), else in
// the source tree.
#pragma once

#include <string>

#include "core/base/file.h"

namespace limber {

// Throws Error when the file is not there: the installation is incomplete.
Path asset(const std::string& name);  // "themes/dark.json"

}  // namespace limber
