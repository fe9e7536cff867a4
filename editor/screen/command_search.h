// SPDX-License-Identifier: AGPL-3.0-or-later
// The command search (F3): finds every command by a few letters of its name and runs it, and finds the pages of the
// user guide that speak of the query's words and opens them.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace limber::editor {

class Dialog;
struct Context;
struct Operator;

struct FoundCommand {
  const Operator* op;
  std::vector<std::size_t> letters;  // byte offsets of the label's letters that match the query
  std::string reason;                // why the command cannot run now; "": it can
  bool is_named = true;              // false: the query matches only its description
};
// Returns the commands that match the query, the best match first. Commands that match by label or category come
// before commands that match only by description. In both groups, commands that cannot run now come last. If the query
// is empty, returns all commands: the five used last, then the others by number of uses, then those never used.
std::vector<FoundCommand> find_commands(const Context& context, const std::string& query);
// Returns the number of commands that the search can find.
int count_commands(const Context& context);

std::unique_ptr<Dialog> open_command_search(Context& context);

}  // namespace limber::editor
