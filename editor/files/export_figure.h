// SPDX-License-Identifier: AGPL-3.0-or-later
// Exports the active view as a figure for a page.
#pragma once

#include "editor/figure/figure_layout.h"

namespace limber::editor {

struct Context;
struct Dialogs;

// Opens a form that asks for the figure's size and parts, then for its file. The form begins with `last`, which gets
// the user's answers.
void ask_for_figure(Dialogs& dialogs, const std::shared_ptr<FigureOptions>& last);
// Writes the active view as a figure. The picture shows everything that the view shows, as large as the figure's size
// allows. Throws Error if the figure has no room for the picture or cannot be written in this format.
void export_figure(Context& context, const FigureOptions& options, const Path& path);

}  // namespace limber::editor
