// SPDX-License-Identifier: AGPL-3.0-or-later
// How a change of a volume reads in tables.
#pragma once

#include <optional>
#include <string>

#include "editor/ui/theme.h"

namespace limber::editor {

std::string figure_of_change(double percent);             // "+1.25"; what rounds to nothing is "+0.00"
std::string percent(const std::optional<double>& value);  // "+1.25 %"; "-" for none
constexpr double kSmallChange = 1;                        // percent: nothing to worry about
Colour colour_of_change(const Theme& theme, const std::optional<double>& percent);

}  // namespace limber::editor
