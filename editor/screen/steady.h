// SPDX-License-Identifier: AGPL-3.0-or-later
// What lies under the pointer in the sidebar stays there: where a text above it comes, goes or grows, the sections are
// shifted by as much until the pointer leaves the sidebar, the user scrolls, or another workspace is shown.
#pragma once

namespace limber::editor {

struct Editor;

// By how far the sections begin below the sidebar's top, pixels. Call in the sidebar's window.
float sidebar_shift();
// The room that is left below the sections, pixels, so that what goes above does not scroll the rest. `end`: where they
// end, from the beginning of what is scrolled.
float sidebar_rest(float end);
// Once after the panels were drawn. True when what the pointer points at has moved: they are to be drawn again.
bool has_moved_under_pointer(Editor& editor);
// Once after a press was met: what it met is what the pointer points at, also where both came in one frame.
void note_pressed(const Editor& editor);

}  // namespace limber::editor
