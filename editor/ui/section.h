// SPDX-License-Identifier: AGPL-3.0-or-later
// A scrolling column of sections and rows: the sidebar, and the inside of dialogs.
#pragma once

#include <string>

#include "editor/ui/widgets.h"

namespace limber::editor {

class Column {
 public:
  // Fills the rectangle; ends with its life.
  Column(Ui& ui, const std::string& name, const Rect& area);
  ~Column();
  Column(const Column&) = delete;
  Column& operator=(const Column&) = delete;

  // The next row over the whole width. Sizes at scale 1.
  Rect row(float height);
  void space(float height) { y_ += ui_.look.px(height); }
  // A section's head, 28 high; true when it is open. Its rows' names begin with the title. `right`: a word at its end.
  bool begin_section(const std::string& title, const std::string& right = "", bool open_at_first = true);
  void end_section();
  // A row of 26 with the label at the left; returns the place of its field, 22 high.
  Rect property(const std::string& label);
  // Of a list: 24 high, every second one shaded, chosen ones in accent. Also for rows that lie outside what is seen:
  // those return false and need not be drawn.
  // `list`: the one that has the keyboard marks its row and brings it into sight.
  bool list_row(Rect& rect, int index, bool chosen, const std::string& list = "");
  const Rect& head() const { return head_; }  // of the section begun last

 private:
  Ui& ui_;
  Rect area_, head_;
  float width_, top_, y_;
};

// One line and one button in the middle of an empty panel.
bool empty_state(Ui& ui, const Rect& rect, const std::string& line, const std::string& button_label);

}  // namespace limber::editor
