// SPDX-License-Identifier: AGPL-3.0-or-later
// The preferences dialog. A change takes effect at once and is saved.
#pragma once

#include <memory>
#include <string>

#include "core/project/job.h"
#include "editor/context/user_folders.h"
#include "editor/input/keymap_overrides.h"
#include "editor/ui/section.h"

namespace limber::editor {

class Dialog;
struct Context;

enum class PreferencesPage { Interface, Keymap, View, Undo, Jobs, Folders };

// Makes the preferences dialog, which opens at the page `page`.
//   search  initial search text of the keymap page
std::unique_ptr<Dialog> open_preferences(PreferencesPage page = PreferencesPage::Interface,
                                         const std::string& search = "");

// The keymap page. After a click on a command's keys, the page waits until the user presses the new key.
class KeymapPage {
 public:
  explicit KeymapPage(std::string search) : search_(std::move(search)) {}
  void draw(Context& context, const Rect& rect);
  bool key(Context& context,
           const Chord& chord);  // returns true if the page was waiting for a key and has used this key
  bool stop_waiting();           // returns true if the page was waiting for a key

 private:
  struct Row {
    std::string context, operator_id, label;
  };
  std::vector<Row> rows(const Context& context) const;
  void draw_head(Context& context, const Rect& rect);
  void draw_row(Context& context, Column& column, int index, const Row& row, const std::vector<Clash>& clashes);
  void draw_foot(Context& context, const Rect& rect, const std::vector<Clash>& clashes);

  std::string search_;
  std::string waiting_context_, waiting_operator_;  // the command that waits for a new key; empty: no command waits
};

// Returns the title of a keymap context, which is the part of the window where keys work, such as "3D view".
std::string title_of_context(const std::string& key_context);

}  // namespace limber::editor
