// SPDX-License-Identifier: AGPL-3.0-or-later
// Determines what a new file inherits from the file that it replaces: its path (the target of symbolic links), its
// permissions, and in messages the name that the user knows.
#pragma once

#include "core/base/error.h"
#include "core/base/file.h"

namespace limber {

// Returns the path of the file that a write to `path` replaces. If `path` is a symbolic link, it is the link's target,
// which need not exist; else it is `path` itself. Throws Error when the links form a circle, or when `path` exists and
// is not a regular file.
Path target_of(const Path& path);

// Gives the open file the permissions, and where allowed the owner and group, of the file that it replaces. Does
// nothing when that file does not exist.
void take_permissions(int descriptor, const Path& replaced);

// Returns the error in which `name`, which the user knows, replaces the file's temporary name.
Error with_name(const Error& error, const Path& temporary, const Path& name);

}  // namespace limber
