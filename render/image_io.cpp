// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/image_io.h"

#include <cmath>

#include <png.h>

#include "core/base/error.h"

namespace limber::render {

namespace {

constexpr std::uint32_t kLargestSide = 16384;
constexpr std::size_t kHeadSize = 33;  // length of a PNG file's signature and first chunk, bytes

void append_big_endian(std::string& bytes, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift & 255);
}

// Returns the PNG chunk pHYs (pixels per metre along both axes), which libpng's simplified interface cannot write.
std::string resolution_chunk(double dots_per_inch) {
  std::string chunk = "pHYs";
  for (int axis = 0; axis < 2; ++axis)
    append_big_endian(chunk, static_cast<std::uint32_t>(std::lround(dots_per_inch / 0.0254)));
  chunk += 1;               // unit of the resolution: metre
  std::uint32_t sum = ~0u;  // CRC-32 of the chunk, bit by bit
  for (const char c : chunk) {
    sum ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (sum & 1 ? 0xEDB88320u : 0);
  }
  std::string whole;
  append_big_endian(whole, static_cast<std::uint32_t>(chunk.size() - 4));
  whole += chunk;
  append_big_endian(whole, ~sum);
  return whole;
}

png_image png_head(const glm::ivec2& size) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<std::uint32_t>(size.x);
  png.height = static_cast<std::uint32_t>(size.y);
  png.format = PNG_FORMAT_RGBA;
  return png;
}

}  // namespace

void write_png(const Image& image, const Path& path, double dots_per_inch) {
  write_file_atomically(path, png_of(image, dots_per_inch));
}

std::string png_of(const Image& image, double dots_per_inch) {
  png_image png = png_head(image.size);
  png_alloc_size_t size = 0;
  std::string bytes;
  if (png_image_write_to_memory(&png, nullptr, &size, 0, image.rgba.data(), 0, nullptr)) {
    bytes.resize(size);
    if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr)) {
      if (dots_per_inch > 0) bytes.insert(kHeadSize, resolution_chunk(dots_per_inch));
      return bytes;
    }
  }
  throw Error("the picture cannot be packed", "PNG", png.message);
}

Image read_png(const Path& path) { return parse_png(read_file(path), path.string()); }

Image parse_png(const std::string& bytes, const std::string& where) {
  png_image png = png_head({0, 0});
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()))
    throw Error("this is not a PNG picture", where, "choose another file");
  if (png.width > kLargestSide || png.height > kLargestSide) {
    png_image_free(&png);
    throw Error("the picture is too large", where, "use one of at most 16384 pixels a side");
  }
  png.format = PNG_FORMAT_RGBA;
  Image image{{static_cast<int>(png.width), static_cast<int>(png.height)},
              std::vector<std::uint8_t>(PNG_IMAGE_SIZE(png))};
  if (!png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr))
    throw Error("the picture is damaged", where, "choose another file");
  return image;
}

}  // namespace limber::render
