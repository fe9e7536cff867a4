// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "core/base/file.h"

namespace limber::cmd {

// A project's parts, as JSON: {"kind": "project", "program", "file_bytes", "chunks", "volume"?, "tissues"?, "bones"?,
// ...}; parts that are absent are left out. Warnings go to stderr. Throws Error as read_project does.
std::string describe_project(const Path& file);

}  // namespace limber::cmd
