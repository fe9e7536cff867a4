// SPDX-License-Identifier: AGPL-3.0-or-later
// Rebuilds a damaged project from its undamaged chunks (core/project/carved_chunks.h).
#pragma once

#include <string>

#include "core/project/carved_chunks.h"
#include "core/project/project_io.h"

namespace limber {

// Returns the project as last saved, as far as its chunks are undamaged. Each save has a root node, the chunk that
// names all parts of the document. When the last save's root node is lost, the latest save whose root node is intact is
// read. When all root nodes are lost, the latest readable part of each kind forms the document, which may be empty. The
// project's warnings say what is missing.
//   where  the file's name in messages
Project put_together(CarvedChunks& chunks, const std::string& where, Progress& progress = no_progress());

}  // namespace limber
