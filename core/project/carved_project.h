// SPDX-License-Identifier: AGPL-3.0-or-later
// A damaged project put together again from the chunks that are whole (core/project/carved_chunks.h).
#pragma once

#include <string>

#include "core/project/carved_chunks.h"
#include "core/project/project_io.h"

namespace limber {

// The document of the last save, as far as it is whole; where its root is lost, that of the latest root there is; where
// none is left, one made of the parts that were written last, which may be none. Its warnings say what is missing.
//   where  names the file in messages
Project put_together(CarvedChunks& chunks, const std::string& where, Progress& progress = no_progress());

}  // namespace limber
