// SPDX-License-Identifier: AGPL-3.0-or-later
// Every command by a few letters of its name (F3).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

struct FoundCommand {
  const Operator* op;
  std::vector<std::size_t> letters;  // bytes of the label that were matched
  std::string reason;                // why it cannot run now; "": it can
};
// Best first, those that cannot run now last. Without a query: the five used last, then the most used, then the rest in
// the menus' order.
std::vector<FoundCommand> find_commands(const Editor& editor, const std::string& query);
// How many commands there are to find.
int count_commands(const Editor& editor);

std::unique_ptr<Dialog> open_command_search();

}  // namespace limber::editor
