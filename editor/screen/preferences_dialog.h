// SPDX-License-Identifier: AGPL-3.0-or-later
// The dialog of preferences: what is changed in it acts at once and is kept.
#pragma once

#include <memory>
#include <string>

#include "editor/ui/section.h"

namespace limber::editor {

enum class PreferencesPage { Interface, Keymap, View, Undo, Jobs, Folders };

// search: what the key map's list begins with
std::unique_ptr<Dialog> open_preferences(PreferencesPage page = PreferencesPage::Interface,
                                         const std::string& search = "");

// The page of keys. Waits for a key while one is to be bound.
class KeymapPage {
 public:
  explicit KeymapPage(std::string search) : search_(std::move(search)) {}
  void draw(Editor& editor, const Rect& rect);
  bool key(Editor& editor, const Chord& chord);  // true when it took the key
  bool stop_waiting();                           // false when it did not wait

 private:
  struct Row {
    std::string context, operator_id, label;
  };
  std::vector<Row> rows(const Editor& editor) const;
  void draw_head(Editor& editor, const Rect& rect);
  void draw_row(Editor& editor, Column& column, int index, const Row& row, const std::vector<Clash>& clashes);
  void draw_foot(Editor& editor, const Rect& rect, const std::vector<Clash>& clashes);

  std::string search_;
  std::string waiting_context_, waiting_operator_;  // whose key is to be pressed
};

// The title of a key map's context: "3D view".
std::string title_of_context(const std::string& context);

}  // namespace limber::editor
