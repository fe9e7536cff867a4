// SPDX-License-Identifier: AGPL-3.0-or-later
// Keeps the sidebar's widget under the pointer at its place on the screen, or the field of a search while the pointer
// is elsewhere. If content above this widget appears, disappears or grows, the sidebar is scrolled to compensate for
// the change in height. Where it cannot be scrolled that far, its sections are shifted; the shift ends when the pointer
// leaves the sidebar, or when another workspace is shown.
#pragma once

namespace limber::editor {

struct Context;

// Returns the shift of the sidebar's sections, which is the distance from the sidebar's top to the first section,
// pixels. Call within the sidebar's ImGui window.
float sidebar_shift();
// Returns the height of the empty space to leave below the sidebar's sections, pixels. Without this space, ImGui would
// scroll when content disappears.
//   end  lower end of the sections, measured from the start of the scrolled content, pixels
float sidebar_rest(float end);
// Updates the shift of the sidebar's sections. Returns true if the shift has changed, so that the panels must be drawn
// again. Call once after the panels are drawn.
bool has_moved_under_pointer(Context& context);
// Stores the widget under the pointer. Call once after a button press was handled, so that the pressed widget stays in
// place even if the pointer came to it in the same frame.
void note_pressed(const Context& context);

}  // namespace limber::editor
