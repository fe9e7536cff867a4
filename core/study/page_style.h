// SPDX-License-Identifier: AGPL-3.0-or-later
// The look of a study's page: the editor's colours, light and dark, and printed. Techniques have a colour and a mark
// each, which differ in lightness too, for eyes that tell fewer colours.
#pragma once

#include <string_view>

namespace limber {

std::string_view page_style();

}  // namespace limber
