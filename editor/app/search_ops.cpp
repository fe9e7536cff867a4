// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator_polls.h"
#include "editor/screen/command_search.h"
#include "editor/ui/icons.h"

namespace limber::editor {

std::vector<Operator> search_operators() {
  return {
      {"search.commands", "Search commands", icon::kSearch, "Help",
       "Find any command by a few letters of its name and run it, or a page of the user guide.",
       [](Editor& e) { e.open_dialog(open_command_search(e)); }},
      {"edit.repeat_last", "Repeat last", icon::kRedo, "Edit", "Run the last command again.",
       [](Editor& e) { run(e, std::string(e.last_operator)); },
       [](const Editor& e) { return e.last_operator.empty() ? std::string("No command was run yet") : std::string(); }},
  };
}

}  // namespace limber::editor
