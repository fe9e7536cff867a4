// SPDX-License-Identifier: AGPL-3.0-or-later
// The length that a view's scale bar stands for: 1, 2, 4, 5, 10, 15, 20 ... micrometres, mm, cm or m.
#pragma once

#include <string>

namespace limber::editor {

struct ScaleLength {
  double millimetres = 0;
  std::string text;  // for example, "15 cm"
};
// Returns the shortest round length that is at least `least`, mm. It is at most twice `least` where `least` is between
// 1 micrometre and 500 m. Below or above it is the shortest or the longest round length.
ScaleLength scale_length(double least);

}  // namespace limber::editor
