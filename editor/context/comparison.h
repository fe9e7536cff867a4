// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>

namespace limber::editor {

// The names of the two results A and B that the views show and compare. A result is a resampled volume. An empty or
// unknown name means the volume at rest.
struct Comparison {
  std::string a, b;
  bool shows_a = false;  // used while nothing is compared. true: the views show result a; false: they show result b
  enum class Views {
    One,         // no comparison: the views show either result a or result b
    Wipe,        // each view is divided by a movable line: a is shown left of the line, b right of it
    SideBySide,  // each view is shown twice with the same camera: a at the left, b at the right
  } views = Views::One;
  float share = 0.5f;  // fraction of a view's width in which a is shown, [0, 1]
};

}  // namespace limber::editor
