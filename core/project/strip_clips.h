// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps strips together with the clips of the document that they play.
#pragma once

#include "core/project/document.h"

namespace limber {

// Lets strips of `next` play the clips as they are there. A clip of `before` that is gone was edited where a clip has
// its name, or renamed where another clip is in its place; otherwise it was deleted, and its strips are removed.
void relink_strips(const Document& before, Document& next);

// Returns the name of a clip of the document whose strips play the clip; nothing if there is none.
std::optional<std::string> clip_with_strips_of(const Document& document, const std::shared_ptr<const Clip>& clip);

}  // namespace limber
