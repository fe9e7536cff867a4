// SPDX-License-Identifier: AGPL-3.0-or-later
// Subcommands that need the renderer or the editor, beside those of core/cmd.
#pragma once

#include <CLI/CLI.hpp>

namespace limber::editor {

void add_editor(CLI::App& app);
void add_render(CLI::App& app);

}  // namespace limber::editor
