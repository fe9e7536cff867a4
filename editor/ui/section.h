// SPDX-License-Identifier: AGPL-3.0-or-later
// A scrolling column of sections and rows, used by the sidebar and inside dialogs.
#pragma once

#include <string>

#include "editor/ui/widgets.h"

namespace limber::editor {

class Column {
 public:
  // Begins a column that fills the rectangle; the destructor ends it.
  Column(Ui& ui, const std::string& name, const Rect& area);
  ~Column();
  Column(const Column&) = delete;
  Column& operator=(const Column&) = delete;

  // Returns the rectangle of the next row, over the whole width. `height` is in pixels at scale 1.
  Rect row(float height);
  void space(float height) { y_ += ui_.look.px(height); }
  // Draws a section's head, 28 pixels high at scale 1, with the text `right` at its right end. Returns true if the
  // section is open. Until end_section(), the title is part of the path of all widgets.
  bool begin_section(const std::string& title, const std::string& right = "", bool open_at_first = true);
  void end_section();
  // Draws a row, 26 pixels high at scale 1, with the label at its left. Returns the rectangle for the row's input
  // field, which is 22 pixels high at scale 1.
  Rect property(const std::string& label);
  // Draws the background of a list's row, 24 pixels high at scale 1: every second row is shaded, selected rows have the
  // accent colour. Call it for every row. Returns false for a row that is scrolled out of sight and need not be drawn.
  //   list  the list's name. If this list has the keyboard, its focused row is outlined and scrolled into sight.
  bool list_row(Rect& rect, int index, bool chosen, const std::string& list = "");
  const Rect& head() const { return head_; }  // rectangle of the head that begin_section() drew last

 private:
  Ui& ui_;
  Rect area_, head_;
  float width_, top_, y_;
};

// Draws one line of text and one button in the middle of an empty panel. Returns true if the button was clicked.
bool empty_state(Ui& ui, const Rect& rect, const std::string& line, const std::string& button_label);

}  // namespace limber::editor
