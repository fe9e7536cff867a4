// SPDX-License-Identifier: AGPL-3.0-or-later
// Which files belong to a volume's name.
#pragma once

#include <vector>

#include "core/base/file.h"

namespace limber {

// Every file that a volume of this name is read from, as far as its header tells: the file itself, and what stands
// beside it. A folder and what is no volume are only themselves. Throws nothing: whoever reads the volume says what is
// wrong with it.
std::vector<Path> files_of_volume(const Path& path);

// The file itself and what is written beside it when a volume, or whatever else, is written under this name.
std::vector<Path> files_written_as(const Path& path);

}  // namespace limber
