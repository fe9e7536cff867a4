// SPDX-License-Identifier: AGPL-3.0-or-later
// The command search (F3): finds every command by a few letters of its name and runs it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

struct FoundCommand {
  const Operator* op;
  std::vector<std::size_t> letters;  // byte offsets of the label's letters that match the query
  std::string reason;                // why the command cannot run now; "": it can
};
// Returns the commands that match the query, the best match first. Commands that match by label or category come
// before commands that match only by description. In both groups, commands that cannot run now come last. If the query
// is empty, returns all commands: the five used last, then the others by number of uses, then those never used.
std::vector<FoundCommand> find_commands(const Editor& editor, const std::string& query);
// Returns the number of commands that the search can find.
int count_commands(const Editor& editor);

std::unique_ptr<Dialog> open_command_search();

}  // namespace limber::editor
