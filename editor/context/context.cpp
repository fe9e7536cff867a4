// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/context.h"

#include "core/project/history.h"
#include "editor/context/screen.h"

namespace limber::editor {

const Document& Context::document() const { return history->current(); }
Workspace Context::workspace() const { return screen->workspace; }

}  // namespace limber::editor
