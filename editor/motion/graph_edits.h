// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of keys through the channels of the graph editor. Each function returns changed keys. `curves` are those of the
// given keys, and every given key exists.
#pragma once

#include "editor/motion/graph.h"

namespace limber::editor {

// A change of frames or of values: x becomes scale * x + shift.
struct GraphMap {
  double scale = 1, shift = 0;

  double at(double x) const { return scale * x + shift; }
  bool operator==(const GraphMap&) const = default;
};
// Moves or scales keys in time and in value. Only the channels among the keys change their value; in time all channels
// of a bone's key go together. Tangents that are set by hand keep their shape in time and value.
//   time   of frames; its scale is positive
//   value  of degrees, or mm for a shift
Keys with_keys_changed(const GraphCurves& curves, const Keys& keys, const std::set<GraphKey>& changed,
                       const GraphMap& time, const GraphMap& value);
// The same with copies of the keys. A key stays as it is unless a copy falls on it.
Keys with_keys_copied(const GraphCurves& curves, const Keys& keys, const std::set<GraphKey>& copied,
                      const GraphMap& time, const GraphMap& value);
int mapped_frame(const GraphMap& time, int frame);
std::set<GraphKey> mapped_keys(const GraphMap& time, const std::set<GraphKey>& keys);
Keys with_keys_deleted(const Keys& keys, const std::set<GraphKey>& deleted);

// Sets how the keys' tracks go on from the keys.
Keys with_interpolation(const Keys& keys, const std::set<GraphKey>& changed, Interpolation interpolation);
// Sets what gives the keys' tangents. Aligned and free handles begin with the tangents that the keys have.
Keys with_handles(const GraphCurves& curves, const Keys& keys, const std::set<GraphKey>& changed, HandleKind handles);
// Sets the slope of one channel at a key, on one side. The handles become aligned, unless they are free.
//   speed  degrees or mm per frame
Keys with_slope(const GraphCurves& curves, const Keys& keys, const GraphKey& key, KeySide side, double speed);

// Eases the spans that begin at the keys. In: slow at first, half of a quadratic curve; out: slow at last.
enum class Easing { In, Out, InOut };
Keys with_easing(const GraphCurves& curves, const Keys& keys, const std::set<GraphKey>& changed, Easing easing);

}  // namespace limber::editor
