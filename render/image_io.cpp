// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/image_io.h"

#include <png.h>

#include "core/base/error.h"

namespace limber::render {

namespace {

constexpr std::uint32_t kLargestSide = 16384;

png_image png_of(const glm::ivec2& size) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<std::uint32_t>(size.x);
  png.height = static_cast<std::uint32_t>(size.y);
  png.format = PNG_FORMAT_RGBA;
  return png;
}

}  // namespace

void write_png(const Image& image, const Path& path) {
  write_atomically(path, [&](const Path& temporary) {
    png_image png = png_of(image.size);
    if (!png_image_write_to_file(&png, temporary.c_str(), 0, image.rgba.data(), 0, nullptr))
      throw Error("the picture cannot be written", path.string(), std::string("make room or choose another folder (") + png.message + ")");
  });
}

Image read_png(const Path& path) {
  const std::string bytes = read_file(path);
  png_image png = png_of({0, 0});
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()))
    throw Error("this is not a PNG picture", path.string(), "choose another file");
  if (png.width > kLargestSide || png.height > kLargestSide) {
    png_image_free(&png);
    throw Error("the picture is too large", path.string(), "use one of at most 16384 pixels a side");
  }
  png.format = PNG_FORMAT_RGBA;
  Image image{{static_cast<int>(png.width), static_cast<int>(png.height)}, std::vector<std::uint8_t>(PNG_IMAGE_SIZE(png))};
  if (!png_image_finish_read(&png, nullptr, image.rgba.data(), 0, nullptr))
    throw Error("the picture is damaged", path.string(), "choose another file");
  return image;
}

}  // namespace limber::render
