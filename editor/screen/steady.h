// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the sidebar's widget under the pointer in place. If content above the widget appears, disappears or grows, all
// sections are shifted by the change in height. The shift ends when the pointer leaves the sidebar or another workspace
// is shown.
#pragma once

namespace limber::editor {

struct Editor;

// Returns the distance from the sidebar's top to the first section, pixels. Call within the sidebar's window.
float sidebar_shift();
// Returns the height of the empty space to leave below the sections, pixels. It prevents scrolling when content above
// disappears. end: lower end of the sections, measured from the start of the scrolled content, pixels.
float sidebar_rest(float end);
// Returns whether the widget under the pointer has moved, so that the panels must be drawn again. Call once after the
// panels are drawn.
bool has_moved_under_pointer(Editor& editor);
// Stores the widget under the pointer. Call once after a button press was handled, so that the pressed widget stays in
// place even if the pointer came to it in the same frame.
void note_pressed(const Editor& editor);

}  // namespace limber::editor
