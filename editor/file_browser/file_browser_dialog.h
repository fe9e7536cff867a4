// SPDX-License-Identifier: AGPL-3.0-or-later
// The file dialog that browse() opens. file_browser.cpp defines what it does, file_browser_view.cpp draws it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/context/dialogs.h"
#include "editor/file_browser/bookmarks.h"
#include "editor/file_browser/file_browser.h"
#include "editor/ui/widgets.h"

namespace limber::editor {

struct Context;

class FileBrowser final : public Dialog {
 public:
  FileBrowser(Context& context, FileRequest request);
  void escape(Context& context) override;
  void draw(Context& context) override;

 private:
  enum class Focus { List, Places };
  bool saving() const { return request_.kind == FileRequest::Kind::Save; }
  bool folders_only() const { return request_.kind == FileRequest::Kind::OpenFolder; }

  void go_to(Context& context, const Path& folder);
  // Gets the folder's entries that the DirectoryReader has read so far, and updates the rows of the list.
  void follow(Context& context);
  void arrange_rows(Context& context);
  const DirectoryEntry* chosen() const { return row_ < std::ssize(rows_) ? &contents_.entries[rows_[row_]] : nullptr; }
  void select(const std::string& name);
  bool path_is_typed() const { return search_.starts_with("/") || search_.starts_with("~"); }

  // Handles the pressed keys. The keyboard can do all that the mouse can.
  void take_keys(Context& context);
  void move_row(Context&);
  // Sets the text of the name field. The field gets a new ImGui id, because ImGui ignores a new text while the user
  // types in the field.
  void set_name(const std::string& name);
  void take_ending(const FileFilter& filter);
  void go_up(Context& context);
  void toggle_hidden(Context& context);

  void leave(Context& context);
  void finish(Context& context, const Path& path);
  // Handles Return and the primary button: opens or saves the selected file, or enters the selected folder.
  void accept(Context& context);
  void accept_typed(Context& context);
  void accept_name(Context& context);
  void enter(Context& context, const DirectoryEntry& entry);
  void make_folder(Context& context);

  void draw_places(Context& context, const Rect& rect);
  // Draws the path of the current folder as a row of buttons, one for each folder of the path, and the search field at
  // the right. If there is not enough room, draws only the last folders of the path.
  void draw_path(Context& context, const Rect& rect);
  static std::string crumb(const Path& path);
  void draw_search(Context& context, const Rect& rect);
  // Returns true if the dialog's text field should get the keyboard, which is whenever no other widget is in use.
  bool wants_focus(Context& context);
  void draw_list(Context& context, const Rect& rect);
  // Draws the row of a file or folder. Returns true when the row was double clicked.
  bool draw_row(Context& context, const DirectoryEntry& entry, const Rect& row, int index, const glm::vec2& columns,
                std::int64_t now);
  static const char* icon_of(const std::string& name);
  void open_row(Context& context, int index);
  void column_head(Context& context, const char* title, const Rect& rect, SortBy by, Align align);
  bool offers_dicom() const { return request_.takes_dicom && contents_.holds_dicom; }
  float draw_dicom_offer(Context& context, const Rect& rect);
  void finish_folder(Context& context);
  float draw_new_folder(Context& context, const Rect& rect);
  void draw_empty(Context& context, const Rect& rect);
  void draw_foot(Context& context, const Rect& rect);
  float draw_filter(Context& context, const Rect& rect);
  void draw_replace(Context& context, const Rect& rect);

  FileRequest request_;
  std::vector<Place> places_;
  Path folder_;
  std::unique_ptr<DirectoryReader> reader_;
  DirectoryContents contents_;
  std::vector<int> rows_;  // the list's rows, as indices of contents_.entries
  std::string search_, name_, remark_, select_after_reading_;
  std::optional<std::string> new_folder_;
  std::optional<Path> replace_;
  SortBy by_ = SortBy::Name;
  Focus focus_ = Focus::List;
  int row_ = 0, place_ = 0, filter_ = 0, text_ = 0;
  bool falling_ = false, changed_ = true, reveal_ = false, refocus_ = true, row_moved_ = false, filter_open_ = false,
       focus_new_folder_ = false;
  bool text_was_empty_ = true;
  bool seen_ = false;       // false in the dialog's first frame, in which a pressed key may have opened the dialog
  bool had_error_ = false;  // true: an error message covered the dialog in the last frame, so keys go to the message
};

}  // namespace limber::editor
