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
  std::vector<std::uint8_t> rgba;  // size.x * size.y * 4
};

void write_png(const Image& image, const Path& path);  // atomic: never leaves a partial file
Image read_png(const Path& path);        // throws Error if it is no PNG, or has a side of more than 16384 pixels
std::string png_of(const Image& image);  // returns the bytes of a PNG file
Image parse_png(const std::string& bytes, const std::string& where);  // the same as read_png, from memory

}  // namespace limber::render
