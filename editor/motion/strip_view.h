// SPDX-License-Identifier: AGPL-3.0-or-later
// The strips' view shows, in place of the timeline's rows or graph, the strips of the shown clip (core/motion/strips.h)
// on their tracks, the highest track at the top. Its time axis is that of the timeline.
//
// Strips are identified by their names, so that undo and redo keep the selection. While strips are dragged, the view
// and the body show them at their new positions; one edit is committed at the end.
#pragma once

#include "core/motion/strip_edits.h"
#include "core/project/document.h"
#include "editor/ui/rect.h"

namespace limber::editor {

struct Context;
struct Timeline;

struct StripView {
  std::set<std::string> chosen;
  std::string active;                     // the strip that the sidebar shows, and that operators of one strip change
  std::string track;                      // the track that operators of one track change
  std::optional<Strips> preview;          // the strips while they are dragged
  std::shared_ptr<const Clip> previewed;  // the clip whose strips `preview` replaces
  std::optional<Rect> box;                // the rectangle that the user draws around strips
  std::optional<int> snapped;             // the frame to which a dragged strip snapped
  float scroll = 0;                       // distance by which the tracks are scrolled, pixels at scale 1
  Rect rows;                              // rectangle in which the strips are drawn, pixels
};

constexpr float kTrackHeight = 26;  // height of a track, pixels at scale 1

StripView& strip_view(Timeline& timeline);  // returns the state of the strips' view; creates it if there is none
bool strips_are_shown(const Context& context);
void show_strips(Context& context, bool on);

// Returns the shown clip's strips, or their preview while they are dragged; nullptr if the clip has none.
const Strips* shown_strips(const Context& context);
double strips_rate(const Document& document);  // the shown clip's rate, frames per second
// Returns the names of the selected strips that exist; empty while the view is hidden.
std::set<std::string> chosen_strips(const Context& context);
const Strip* active_strip(const Context& context);  // returns the active strip; nullptr: none is active
std::optional<std::size_t> active_track(const Context& context);
// Selects this strip and deselects all others.
void choose_strip(Context& context, const std::string& name);

// ---- Edits of the shown clip's strips

// Commits an edit of the strips. If the clip had no strips, or its playing range was the range of frames that the
// strips filled, the playing range becomes the range that the changed strips fill.
void change_strips(Context& context, const std::string& label, const std::function<void(Strips&)>& edit);
// Shows these strips instead of the clip's, in the view and in the body's pose, until drop_strip_preview() is called.
void preview_strips(Context& context, Strips strips);
void drop_strip_preview(Context& context);
// Commits an edit of the active strip, as change_strips() does.
void change_active_strip(Context& context, const std::string& label, const std::function<void(Strip&)>& edit);
void preview_active_strip(Context& context, const std::function<void(Strip&)>& edit);

// ---- Positions in the strips' view
Rect track_rect(const Context& context, std::size_t track);  // the track's row over its whole width, pixels
Rect strip_rect(const Context& context, const StripPlace& place);
// Returns the index of the track at the y coordinate `y` of the window, pixels. The lowest track has the index 0. Above
// and below the tracks, the returned index belongs to no track.
int track_at(const Context& context, float y);
void scroll_tracks(Context& context, float by);  // moves the tracks by this distance, pixels at scale 1

}  // namespace limber::editor
