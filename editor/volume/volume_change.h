// SPDX-License-Identifier: AGPL-3.0-or-later
// Formats a tissue's change of volume, in percent, for tables.
#pragma once

#include <optional>
#include <string>

#include "editor/ui/theme.h"

namespace limber::editor {

// Returns a change in percent as text: "+1.25"; "+0.00" if it rounds to zero.
std::string figure_of_change(double percent);
std::string percent(const std::optional<double>& value);  // returns a change as text: "+1.25 %"; "-" if there is none
// A change up to this size has the colour of a good value in tables, percent.
constexpr double kSmallChange = 1;
Colour colour_of_change(const Theme& theme, const std::optional<double>& percent);

}  // namespace limber::editor
