// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes seams as one line of text for headers of other files, and reads them back. A face has the number 3 * (index of
// its lower voxel) + axis. The numbers are sorted, and each is stored as its difference from the previous one. A
// difference is written in groups of seven bits, the lowest first. Each group is a byte of two hexadecimal digits,
// whose eighth bit is set when more bytes follow.
#pragma once

#include <string>
#include <string_view>

#include "core/volume/seams.h"

namespace limber {

std::string text_of_seams(const Seams& seams);
// Reads seams from text. Throws Error when the text is not valid or names a face outside the grid; `where` is the file.
Seams seams_of_text(std::string_view text, const glm::ivec3& grid_size, const std::string& where);

}  // namespace limber
