// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the files of the editor's fonts.
#pragma once

#include <string>

namespace limber::editor {

enum class FontFile { Inter, InterSemiBold, JetBrainsMono, FontAwesome };

// Returns the path of a font: one that came with the program, else that of Debian's package. Throws Error, which names
// the package, if there is neither.
std::string font_file(FontFile font);

}  // namespace limber::editor
