// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

#include "core/base/file.h"

namespace limber::cmd {

// Describes the parts of a project as JSON: {"kind": "project", "program", "file_bytes", "chunks", "volume"?,
// "tissues"?, "bones"?, ...}. Absent parts are left out. Warnings go to stderr. Throws Error for a file that
// read_project() cannot read.
std::string describe_project(const Path& file);

}  // namespace limber::cmd
