// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the kind of a file from its name and content.
#pragma once

#include <string>

#include "core/base/file.h"

namespace limber::editor {

// Kinds of files. Files that are opened together are imported in the order of these kinds.
enum class FileKind { Project, Volume, Tissues, Rig, Weights, Motion, Pose };
// Returns the kind of a file. Throws Error if the file is missing or is not of one of these kinds.
FileKind kind_of(const Path& path);

std::string extension_of(const Path& path);  // in lower case, such as ".bvh"

}  // namespace limber::editor
