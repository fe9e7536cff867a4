// SPDX-License-Identifier: AGPL-3.0-or-later
// The state that widgets share: the look, this frame's input, the keyboard focus, the tool tip. Every widget's function
// gets a Ui as its argument.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "editor/input/events.h"
#include "editor/ui/style.h"
#include "editor/ui/widget_registry.h"

namespace limber::editor {

// The text field that has the keyboard (keyboard.h).
struct Keyboard {
  bool typed = false;    // a text field had the keyboard when the panels were drawn last
  unsigned awaited = 0;  // ImGui's id of the field that will get the keyboard; 0: the field was not drawn yet
  int turns = 0;  // number of draws of the panels for which keys still wait for the awaited field; 0: keys do not wait

  bool waits() const { return turns > 0; }
};

// The list that has the keyboard, and its focused row (list_navigation.h).
struct ListFocus {
  std::string list;  // name of the list; empty: no list has the keyboard
  int row = 0;
  bool reveal = false;  // true: scrolls the row into sight in the next frame
};

// A row of a list that is being renamed. `what` identifies the row, `text` is the name as typed so far.
struct Renaming {
  std::string what, text;
  bool shown = false;  // true: the row's text field has been drawn
};

struct Ui {
  // Requests the next few frames, for a change that no input event caused.
  void touch() { frames_wanted_ = 3; }
  // Requests a frame at `time` (seconds on the clock of `now`), even if no input arrives until then.
  void wake_at(double time) { wake_at_ = std::min(wake_at_, std::max(time, now)); }

  void begin_frame(double time) {
    now = time;
    wake_at_ = 1e300;
    if (frames_wanted_ > 0) --frames_wanted_;
  }
  // Returns the time until the next requested frame, s; 0 or less: now.
  double time_to_next_frame() const { return frames_wanted_ > 0 ? 0 : wake_at_ - now; }

  Look look;
  WidgetRegistry widgets;
  InputState input;
  Keyboard keyboard;
  double now = 0;            // time of this frame, s
  Rect window;               // rectangle of the window, pixels
  double tooltip_delay = 0;  // delay before a tool tip appears, s
  bool dialog_open = false;  // true: the dialog gets the keys instead of lists

  ListFocus list_focus;
  std::optional<Renaming> renaming;
  std::map<std::string, bool> open_sections;  // true: a section of a column is open; by the section's title
  std::string wanted_section;                 // the section to scroll to in the next frame; empty: no section

  // The region of the window that is being drawn, and the path with which the names of its widgets begin.
  struct {
    Region region = Region::Views;
    std::vector<std::string> steps;
    std::vector<std::string> windows;  // names of the ImGui windows of this frame's regions, back to front
  } place;

  // The tool tip of the widget under the pointer. `since` is the time at which the pointer entered the widget, s.
  struct {
    std::string widget, title, description;
    std::optional<Chord> chord;
    Rect rect;
    double since = 0;
    bool asked = false;  // true: tooltip() was called in this frame
  } tip;

 private:
  int frames_wanted_ = 3;   // number of frames still to draw: ImGui needs up to 3 to show a change
  double wake_at_ = 1e300;  // earliest time for which wake_at() has requested a frame, s
};

}  // namespace limber::editor
