// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator_polls.h"
#include "editor/dialogs/text_viewer.h"
#include "editor/screen/help_dialog.h"
#include "editor/ui/icons.h"

namespace limber::editor {

std::vector<Operator> help_operators() {
  return {
      {"help.guide", "User guide", icon::kHelp, "Help", "How to go from a volume to a posed one, page by page.",
       [](Editor& e) { e.open_dialog(open_document("User guide", "docs/guide.md")); }},
      {"help.new", "What is new", icon::kInfo, "Help", "What this version can do that the one before could not.",
       [](Editor& e) { e.open_dialog(open_document("What is new", "docs/new.md")); }},
      {"help.keys", "Keys", icon::kKeyboard, "Help", "Every key and what it does.",
       [](Editor& e) { e.open_dialog(open_keys_page()); }},
      {"help.last_error", "Details", icon::kError, "Help", "Shows the last failure of a job again, with what to do.",
       [](Editor& e) { e.messages.show_again(e.messages.last_failure); },
       [](const Editor& e) {
         return e.messages.last_failure.empty() ? std::string("No job has failed") : std::string();
       }},
      {"help.system_facts", "Copy system facts", icon::kCopy, "Help",
       "Puts version, driver and window on the clipboard, for a report of a mistake.",
       [](Editor& e) {
         e.host.set_clipboard(system_facts(e));
         e.messages.ok("System facts copied");
       }},
      {"help.about", "About and licences", icon::kInfo, "Help", "Version, licence, and what Limber is made with.",
       [](Editor& e) { e.open_dialog(open_about_page()); }},
  };
}

}  // namespace limber::editor
