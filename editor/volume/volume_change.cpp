// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/volume_change.h"

#include <cmath>
#include <cstdio>

namespace limber::editor {

std::string figure_of_change(double percent) {
  char text[24];
  std::snprintf(text, sizeof text, "%+.2f", std::abs(percent) < 0.005 ? 0.0 : percent);
  return text;
}

std::string percent(const std::optional<double>& value) { return value ? figure_of_change(*value) + " %" : "-"; }

Colour colour_of_change(const Theme& theme, const std::optional<double>& percent) {
  if (!percent) return theme.text2;
  return std::abs(*percent) <= kSmallChange ? theme.ok : std::abs(*percent) <= 5 ? theme.warn : theme.error;
}

}  // namespace limber::editor
