// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator_polls.h"
#include "editor/context/operator_registry.h"
#include "editor/screen/command_search.h"
#include "editor/ui/icons.h"

namespace limber::editor {

std::vector<Operator> search_operators() {
  return {
      {"search.commands", "Search commands", icon::kSearch, "Help",
       "Find any command by a few letters of its name and run it, or a page of the user guide.",
       [](Context& c) { c.dialogs->open(open_command_search(c)); }},
      {"edit.repeat_last", "Repeat last", icon::kRedo, "Edit", "Run the last command again.",
       [](Context& c) { run(c, std::string(c.operators->last)); },
       [](const Context& c) {
         return c.operators->last.empty() ? std::string("No command was run yet") : std::string();
       }},
  };
}

}  // namespace limber::editor
