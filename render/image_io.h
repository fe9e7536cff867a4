// SPDX-License-Identifier: AGPL-3.0-or-later
// Pictures: 8-bit RGBA, rows from the top; written and read as PNG.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/file.h"

namespace limber::render {

struct Image {
  glm::ivec2 size{0};
  std::vector<std::uint8_t> rgba;  // size.x * size.y * 4
};

void write_png(const Image& image, const Path& path);  // whole or not at all
Image read_png(const Path& path);                      // throws Error for what is no PNG, or over 16384 pixels a side
std::string png_of(const Image& image);                // the bytes of the file
Image parse_png(const std::string& bytes, const std::string& where);  // as read_png

}  // namespace limber::render
