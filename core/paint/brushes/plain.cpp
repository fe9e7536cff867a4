// SPDX-License-Identifier: AGPL-3.0-or-later
// Implements the plain brushes, which compute a voxel's new weight only from its old weight of the painted bones.
#include <algorithm>

#include "core/paint/brush_rule.h"

namespace limber {

namespace {

int drawn_to(double to, int before, int covered) {
  const double made = before + (to - before) * (covered / double(kFullWeight));
  return static_cast<int>(std::clamp(made, 0.0, double(kFullWeight)) + 0.5);
}

}  // namespace

BrushRule add_brush() {
  return {.id = "add",
          .name = "Add",
          .description = "Adds to the active bone's weight.",
          .paint = [](double before, double cover, double full, const Brush&) { return before + cover * full; },
          .paint_whole = [](int before, int covered, const Brush&) { return std::min(before + covered, kFullWeight); }};
}

BrushRule subtract_brush() {
  return {.id = "subtract",
          .name = "Subtract",
          .description = "Reduces the active bone's weight.",
          .paint = [](double before, double cover, double full, const Brush&) { return before - cover * full; },
          .paint_whole = [](int before, int covered, const Brush&) { return std::max(before - covered, 0); }};
}

BrushRule set_brush() {
  return {.id = "set",
          .name = "Set",
          .description = "Sets the active bone's weight to the brush's value.",
          .takes_value = true,
          .paint = [](double before, double cover, double full,
                      const Brush& brush) { return before + (brush.value * full - before) * cover; },
          .paint_whole = [](int before, int covered,
                            const Brush& brush) { return drawn_to(brush.value * kFullWeight, before, covered); }};
}

BrushRule multiply_brush() {
  return {.id = "multiply",
          .name = "Multiply",
          .description = "Multiplies the active bone's weight by the brush's value.",
          .takes_value = true,
          .paint = [](double before, double cover, double,
                      const Brush& brush) { return before * (1 + (brush.value - 1) * cover); },
          .paint_whole = [](int before, int covered,
                            const Brush& brush) { return drawn_to(before * brush.value, before, covered); }};
}

}  // namespace limber
