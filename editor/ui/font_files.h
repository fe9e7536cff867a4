// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the files of the editor's fonts.
#pragma once

#include <string>

namespace limber::editor {

enum class FontFile { Inter, InterSemiBold, JetBrainsMono, FontAwesome };

// Returns the path of a font: the file that comes with the program, otherwise the file of Debian's package. Throws
// Error, which names the package, if neither exists.
std::string font_file(FontFile font);

}  // namespace limber::editor
