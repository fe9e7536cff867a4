// SPDX-License-Identifier: AGPL-3.0-or-later
// What widgets draw with, and what they remember from frame to frame. Every widget gets it as its argument; the editor
// is one.
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

// Which text field has the keyboard (keyboard.h).
struct Keyboard {
  bool typed = false;    // a text field had it when the panels were drawn last
  unsigned awaited = 0;  // ImGui's id of the field that is to get it; 0: not drawn yet
  int turns = 0;         // how many times more the panels may be drawn before keys stop waiting for it

  bool waits() const { return turns > 0; }
};

// Which list has the keyboard, and where in it (list_navigation.h).
struct ListFocus {
  std::string list;  // empty: none has it
  int row = 0;
  bool reveal = false;  // bring the row into sight
};

// The thing that is being renamed, under a name that no other has.
struct Renaming {
  std::string what, text;
  bool shown = false;  // its field stands
};

struct Ui {
  // Draws again, after something changed that no event tells of.
  void touch() { frames_wanted_ = 3; }
  // Draws again at that time, in seconds, though nothing happens until then.
  void wake_at(double time) { wake_at_ = std::min(wake_at_, std::max(time, now)); }

  Look look;
  WidgetRegistry widgets;
  InputState input;
  Keyboard keyboard;
  double now = 0;            // s, of this frame
  Rect window;               // pixels
  double tooltip_delay = 0;  // s
  bool dialog_open = false;  // lists leave the keyboard to it

  ListFocus list_focus;
  std::optional<Renaming> renaming;
  std::map<std::string, bool> open_sections;  // of columns, by title
  std::string wanted_section;                 // comes into sight in the next frame; empty: none

  // Where the panel that is being drawn stands: the beginning of its widgets' names.
  struct {
    Region region = Region::Views;
    std::vector<std::string> steps;
    std::vector<std::string> windows;  // of the regions of this frame, back to front
  } place;

  // The tool tip to come: which widget is pointed at, since when.
  struct {
    std::string widget, title, description;
    std::optional<Chord> chord;
    Rect rect;
    double since = 0;
    bool asked = false;  // in this frame
  } tip;

 protected:
  int frames_wanted_ = 3;   // ImGui settles a change within that many
  double wake_at_ = 1e300;  // s
};

}  // namespace limber::editor
