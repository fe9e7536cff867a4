// SPDX-License-Identifier: AGPL-3.0-or-later
// Rebuilds a damaged project from its undamaged chunks (core/project/carved_chunks.h).
#pragma once

#include <string>

#include "core/project/carved_chunks.h"
#include "core/project/project_io.h"

namespace limber {

// Returns the project as last saved, as far as its chunks are undamaged. When the root node of the last save is lost,
// takes the latest save whose root node survives. When no root node survives, assembles a document from the part of
// each kind that was written last; this document may be empty. The project's warnings say what is missing.
//   where  the file's name in messages
Project put_together(CarvedChunks& chunks, const std::string& where, Progress& progress = no_progress());

}  // namespace limber
