// SPDX-License-Identifier: AGPL-3.0-or-later
// The style sheet of a study's page: the editor's colours in light mode, in dark mode and for print. Each technique
// (way of posing) has a colour and a mark. The colours also differ in lightness, for colour-blind readers. The fonts
// are part of the style sheet (assets/fonts), so that a page looks and prints alike everywhere, and its PDF contains
// them.
#pragma once

#include <string>

namespace limber {

std::string page_style();

}  // namespace limber
