// SPDX-License-Identifier: AGPL-3.0-or-later
// Limits on the textures in which a volume is drawn. A volume beyond them is drawn at half its resolution, or less.
#pragma once

#include <cstdint>
#include <limits>

namespace limber::render {

struct TextureLimits {
  int side = 0;  // largest number of texels per axis of a 3D texture
  // Largest number of bytes that the labels and one surface may use on the graphics card, without the driver's own
  // copies.
  std::int64_t bytes = std::numeric_limits<std::int64_t>::max();
};

}  // namespace limber::render
