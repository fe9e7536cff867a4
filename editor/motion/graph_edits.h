// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of keys in the channels of the graph editor. Each function returns the changed keys. `curves` must be the
// curves of the given keys, and every given key must exist.
#pragma once

#include "editor/motion/graph.h"

namespace limber::editor {

// A linear map of frames or of values: x becomes scale * x + shift.
struct GraphMap {
  double scale = 1, shift = 0;

  double at(double x) const { return scale * x + shift; }
  bool operator==(const GraphMap&) const = default;
};
// Moves or scales keys in time and in value. Only the selected channels change their value, but a frame change moves
// all channels of a bone's key. Tangents that the user has set are scaled with the keys.
//   time   maps frames; its scale is positive
//   value  maps degrees, or mm if the track is the body's translation
Keys with_keys_changed(const GraphCurves& curves, const Keys& keys, const std::set<GraphKey>& changed,
                       const GraphMap& time, const GraphMap& value);
// Copies the keys and moves or scales the copies as with_keys_changed() does. A copy replaces an existing key at the
// same frame.
Keys with_keys_copied(const GraphCurves& curves, const Keys& keys, const std::set<GraphKey>& copied,
                      const GraphMap& time, const GraphMap& value);
int mapped_frame(const GraphMap& time, int frame);
std::set<GraphKey> mapped_keys(const GraphMap& time, const std::set<GraphKey>& keys);
Keys with_keys_deleted(const Keys& keys, const std::set<GraphKey>& deleted);

// Sets how the tracks interpolate from each of these keys to the next.
Keys with_interpolation(const Keys& keys, const std::set<GraphKey>& changed, Interpolation interpolation);
// Sets the handle kind, which decides the keys' tangents. Aligned and free handles start with the keys' current
// tangents.
Keys with_handles(const GraphCurves& curves, const Keys& keys, const std::set<GraphKey>& changed, HandleKind handles);
// Sets the slope of one channel at a key, on one side of the key. The handles become aligned, unless they are free.
//   speed  slope, degrees or mm per frame
Keys with_slope(const GraphCurves& curves, const Keys& keys, const GraphKey& key, KeySide side, double speed);

// Eases the spans that begin at the keys. In: slow at first, as half of a quadratic curve. Out: slow at the end. InOut:
// slow at both ends.
enum class Easing { In, Out, InOut };
Keys with_easing(const GraphCurves& curves, const Keys& keys, const std::set<GraphKey>& changed, Easing easing);

}  // namespace limber::editor
