// SPDX-License-Identifier: AGPL-3.0-or-later
// The style sheet of a study's page: the editor's colours in light mode, in dark mode and for print. Each technique
// (way of posing) has a colour and a mark. The colours also differ in lightness, for colour-blind readers.
#pragma once

#include <string_view>

namespace limber {

std::string_view page_style();

}  // namespace limber
