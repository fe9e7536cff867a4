// SPDX-License-Identifier: AGPL-3.0-or-later
// Formats a tissue's change of volume, in percent, for tables.
#pragma once

#include <optional>
#include <string>

#include "editor/ui/theme.h"

namespace limber::editor {

std::string figure_of_change(double percent);             // "+1.25"; "+0.00" if the number rounds to zero
std::string percent(const std::optional<double>& value);  // "+1.25 %"; "-" for none
constexpr double kSmallChange = 1;                        // changes up to this size are coloured as good, percent
Colour colour_of_change(const Theme& theme, const std::optional<double>& percent);

}  // namespace limber::editor
