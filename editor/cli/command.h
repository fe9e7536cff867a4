// SPDX-License-Identifier: AGPL-3.0-or-later
// Adds the subcommands of the command line that need the renderer or the editor. All other subcommands are in core/cmd.
#pragma once

#include <CLI/CLI.hpp>

namespace limber::editor {

void add_editor(CLI::App& app);
void add_guide(CLI::App& app);
void add_render(CLI::App& app);

}  // namespace limber::editor
