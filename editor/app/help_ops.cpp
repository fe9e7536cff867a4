// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/platform_window.h"
#include "editor/dialogs/text_viewer.h"
#include "editor/guide/guide_reader.h"
#include "editor/screen/help_dialog.h"
#include "editor/ui/icons.h"
#include "editor/ui/messages.h"

namespace limber::editor {

std::vector<Operator> help_operators() {
  return {
      {"help.guide", "User guide", icon::kHelp, "Help",
       "Read how each task is done, from opening a volume to a result; a search finds every page.",
       [](Context& c) { c.dialogs->open(open_guide(read_guide(c))); }},
      {"help.new", "What is new", icon::kInfo, "Help", "Read what is new in this version.",
       [](Context& c) { c.dialogs->open(open_document("What is new", "docs/new.md")); }},
      {"help.keys", "Keys", icon::kKeyboard, "Help", "List all keyboard shortcuts and the commands that they run.",
       [](Context& c) { c.dialogs->open(open_keys_page()); }},
      {"help.last_error", "Error details", icon::kError, "Help",
       "Show the error of the last failed job, and what to do about it.",
       [](Context& c) { c.messages->show_again(c.messages->last_failure); },
       [](const Context& c) {
         return c.messages->last_failure.empty() ? std::string("No job has failed") : std::string();
       }},
      {"help.system_facts", "Copy system facts", icon::kCopy, "Help",
       "Copy the program's version, the graphics driver and the window size to the clipboard, for a bug report.",
       [](Context& c) {
         c.host->set_clipboard(system_facts(c));
         c.messages->ok("System facts copied");
       }},
      {"help.about", "About and licences", icon::kInfo, "Help",
       "Show the version, the licence and the libraries of Limber.",
       [](Context& c) { c.dialogs->open(open_about_page()); }},
  };
}

}  // namespace limber::editor
