// SPDX-License-Identifier: AGPL-3.0-or-later
// Seams as one line of text, for headers of other files: the numbers of their faces, 3 * place of the lower voxel +
// axis, in rising order, each as its distance from the one before, in bytes of seven bits (the eighth: more follow),
// lowest first, in two hexadecimal digits each.
#pragma once

#include <string>
#include <string_view>

#include "core/volume/seams.h"

namespace limber {

std::string text_of_seams(const Seams& seams);
// Throws Error where the text is none, or names a face outside the grid; `where` is the file.
Seams seams_of_text(std::string_view text, const glm::ivec3& grid_size, const std::string& where);

}  // namespace limber
