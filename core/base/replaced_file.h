// SPDX-License-Identifier: AGPL-3.0-or-later
// Determines the path of the file that a new file replaces (the target of symbolic links). Replaces the temporary name
// of a file in error messages by the name that the user knows.
#pragma once

#include "core/base/error.h"
#include "core/base/file.h"

namespace limber {

// Returns the path of the file that a write to `path` replaces: the link's target if `path` is a symbolic link (the
// target need not exist), else `path` itself. Throws Error when the links form a circle, or when `path` exists and is
// not a regular file.
Path target_of(const Path& path);

// Returns the error with the file's temporary name replaced by `name`, which the user knows.
Error with_name(const Error& error, const Path& temporary, const Path& name);

}  // namespace limber
