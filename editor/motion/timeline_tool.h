// SPDX-License-Identifier: AGPL-3.0-or-later
// What the pointer does in the timeline.
#pragma once

#include "editor/context/editor.h"
#include "editor/motion/timeline.h"

namespace limber::editor {

double frame_at(const Timeline& timeline, float x);
float x_of(const Timeline& timeline, double frame);
constexpr double kFewestFrames = 8;  // seen at once
// The whole clip and its range, with a little room.
void fit_window(Editor& editor);
void fit_window_to_keys(Editor& editor);  // the chosen ones; needs some

// A press of the left button: shows the frame under the pointer until it is released; on a key it chooses that (Shift:
// as well), and drags the chosen ones.
void press_timeline(Editor& editor);
// With Ctrl: the keys inside the rectangle that is drawn are chosen.
void box_keys(Editor& editor);
// The chosen keys follow the pointer, or a typed number, until they are confirmed.
enum class KeyChange { Move, Scale, Duplicate };
void begin_changing_keys(Editor& editor, KeyChange change);
// Of the middle button.
void pan_timeline(Editor& editor);

}  // namespace limber::editor
