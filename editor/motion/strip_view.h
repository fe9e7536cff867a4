// SPDX-License-Identifier: AGPL-3.0-or-later
// The strips' view: the timeline's third face, which shows the strips of the shown clip (core/motion/strips.h) on their
// tracks, the highest track at the top. Its time axis is the timeline's.
//
// Strips are known by their names, so that undo and redo keep what is selected. While strips are dragged, the view and
// the body show them where the pointer has them; one edit is committed at the end.
#pragma once

#include "core/motion/strip_edits.h"
#include "editor/motion/timeline.h"

namespace limber::editor {

struct StripView {
  std::set<std::string> chosen;
  std::string active;                     // the strip that the sidebar shows, and that operators of one strip change
  std::string track;                      // the track that operators of one track change
  std::optional<Strips> preview;          // the strips while they are dragged
  std::shared_ptr<const Clip> previewed;  // the clip whose strips `preview` replaces
  std::optional<Rect> box;                // the rectangle that the user draws around strips
  std::optional<int> snapped;             // the frame to which a dragged strip snapped
  float scroll = 0;                       // how far the tracks are scrolled, pixels at scale 1
  Rect rows;                              // where strips are drawn
};

constexpr float kTrackHeight = 26;  // pixels at scale 1

StripView& strip_view(Editor& editor);  // creates the state if there is none
bool strips_are_shown(const Editor& editor);
void show_strips(Editor& editor, bool on);

const Strips* shown_strips(const Editor& editor);  // as they are dragged now; nullptr if the shown clip has none
double strips_rate(const Editor& editor);          // of the shown clip, frames per second
std::set<std::string> chosen_strips(const Editor& editor);  // those that exist, while the view is shown
const Strip* active_strip(const Editor& editor);            // nullptr: none
std::optional<std::size_t> active_track(const Editor& editor);
// Selects one strip alone.
void choose_strip(Editor& editor, const std::string& name);

// ---- Edits of the shown clip's strips

// Commits one edit. If the playing range was that of the strips, it stays so.
void change_strips(Editor& editor, const std::string& label, const std::function<void(Strips&)>& edit);
// Shows strips in place of the clip's, in the view and by the body's pose, until drop_strip_preview() is called.
void preview_strips(Editor& editor, Strips strips);
void drop_strip_preview(Editor& editor);
// The same for the active strip.
void change_active_strip(Editor& editor, const std::string& label, const std::function<void(Strip&)>& edit);
void preview_active_strip(Editor& editor, const std::function<void(Strip&)>& edit);

// ---- Places in the view
Rect track_rect(const Editor& editor, std::size_t track);  // of the rows, over their whole width
Rect strip_rect(const Editor& editor, const StripPlace& place);
// Returns the number of the track at a height of the view, counted from the lowest, which may lie beyond the tracks.
int track_at(const Editor& editor, float y);
void scroll_tracks(Editor& editor, float by);  // pixels at scale 1

}  // namespace limber::editor
