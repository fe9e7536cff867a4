// SPDX-License-Identifier: AGPL-3.0-or-later
// Converts between frames and pixels of the timeline, fits the shown frames to the keys or the motion, and handles the
// pointer in the timeline: scrubbing, selecting and changing keys, and panning.
#pragma once

namespace limber::editor {

struct Context;
struct Timeline;

double frame_at(const Timeline& timeline, float x);
float x_of(const Timeline& timeline, double frame);
constexpr double kFewestFrames = 8;  // the timeline shows at least this many frames, however far the user zooms in
// Fits the whole motion and the playing range into the timeline, with a small margin on both sides.
void fit_window(Context& context);
void fit_window_to_keys(Context& context);  // fits the selected keys into the timeline; needs selected keys

// Handles a press of the left button in the timeline. On a key, selects the key (Shift: adds it to the selection or
// removes it) and drags the selected keys. Elsewhere, deselects all keys and shows the frame under the pointer while
// the button is held.
void press_timeline(Context& context);
// Begins to draw a rectangle that selects the keys inside. With Shift, these keys are added to the selection.
void box_keys(Context& context);
// Begins a modal tool that moves, scales or duplicates the selected keys by the pointer or a typed number.
enum class KeyChange { Move, Scale, Duplicate };
void begin_changing_keys(Context& context, KeyChange change);
// Pans the timeline while the middle button is held.
void pan_timeline(Context& context);

}  // namespace limber::editor
