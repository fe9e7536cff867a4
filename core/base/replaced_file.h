// SPDX-License-Identifier: AGPL-3.0-or-later
// What a file that takes another's place takes over from it: the end of symbolic links, permissions, and in messages
// the name that the user knows.
#pragma once

#include "core/base/error.h"
#include "core/base/file.h"

namespace limber {

// What a write to `path` replaces: at the end of symbolic links the file that they name, there or not; else the path
// itself. throws Error when the links go round in a circle, or what is there is no regular file
Path target_of(const Path& path);

// Gives the open file the permissions, and where it may the owner and group, of the file that it is about to replace.
// Nothing where there is none.
void take_permissions(int descriptor, const Path& replaced);

// The error with the name that the user knows in place of a temporary one.
Error with_name(const Error& error, const Path& temporary, const Path& name);

}  // namespace limber
