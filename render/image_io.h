// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes and reads pictures as PNG: 8-bit RGBA, rows from top to bottom.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/file.h"

namespace limber::render {

struct Image {
  glm::ivec2 size{0};
  std::vector<std::uint8_t> rgba;  // size.x * size.y * 4 bytes, rows from top to bottom
};

// Writes a PNG file atomically: never leaves a partial file.
//   dots_per_inch  resolution stored in the file for programs that print or place the picture; 0: the file has no
//                  resolution
void write_png(const Image& image, const Path& path, double dots_per_inch = 0);
// Reads a PNG file. Throws Error if the file is not a PNG, or if it is wider or higher than 16384 pixels.
Image read_png(const Path& path);
std::string png_of(const Image& image, double dots_per_inch = 0);  // returns the bytes of a PNG file
// Reads the bytes of a PNG file as read_png() does. Error messages call the file `where`.
Image parse_png(const std::string& bytes, const std::string& where);

}  // namespace limber::render
