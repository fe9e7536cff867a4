// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator_polls.h"
#include "editor/dialogs/text_viewer.h"
#include "editor/guide/guide_reader.h"
#include "editor/screen/help_dialog.h"
#include "editor/ui/icons.h"

namespace limber::editor {

std::vector<Operator> help_operators() {
  return {
      {"help.guide", "User guide", icon::kHelp, "Help",
       "Read how each task is done, from opening a volume to a result; a search finds every page.",
       [](Editor& e) { e.open_dialog(open_guide(read_guide(e))); }},
      {"help.new", "What is new", icon::kInfo, "Help", "Read what is new in this version.",
       [](Editor& e) { e.open_dialog(open_document("What is new", "docs/new.md")); }},
      {"help.keys", "Keys", icon::kKeyboard, "Help", "List all keyboard shortcuts and the commands that they run.",
       [](Editor& e) { e.open_dialog(open_keys_page()); }},
      {"help.last_error", "Error details", icon::kError, "Help",
       "Show the error of the last failed job, and what to do about it.",
       [](Editor& e) { e.messages.show_again(e.messages.last_failure); },
       [](const Editor& e) {
         return e.messages.last_failure.empty() ? std::string("No job has failed") : std::string();
       }},
      {"help.system_facts", "Copy system facts", icon::kCopy, "Help",
       "Copy the program's version, the graphics driver and the window size to the clipboard, for a bug report.",
       [](Editor& e) {
         e.host.set_clipboard(system_facts(e));
         e.messages.ok("System facts copied");
       }},
      {"help.about", "About and licences", icon::kInfo, "Help",
       "Show the version, the licence and the libraries of Limber.",
       [](Editor& e) { e.open_dialog(open_about_page()); }},
  };
}

}  // namespace limber::editor
