// SPDX-License-Identifier: AGPL-3.0-or-later
// Lists the files of which a volume consists: a format may keep header and voxels in separate files.
#pragma once

#include <vector>

#include "core/base/file.h"

namespace limber {

// Returns every file from which the volume `path` is read: `path` itself, its header and the data files that the header
// names. For a folder, or a file that is not a volume, returns only `path`. Never throws Error, because reading the
// volume reports what is wrong with it.
std::vector<Path> files_of_volume(const Path& path);

// Returns `path` itself and the data files that may be created beside it when a volume is written to `path`.
std::vector<Path> files_written_as(const Path& path);

}  // namespace limber
