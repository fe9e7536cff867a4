// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/image_io.h"

#include <png.h>

#include "core/base/error.h"

namespace limber::render {

namespace {

constexpr std::uint32_t kLargestSide = 16384;

png_image png_head(const glm::ivec2& size) {
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
    png_image png = png_head(image.size);
    if (!png_image_write_to_file(&png, temporary.string().c_str(), 0, image.rgba.data(), 0, nullptr))
      throw Error("the picture cannot be written", path.string(),
                  std::string("make room or choose another folder (") + png.message + ")");
  });
}

std::string png_of(const Image& image) {
  png_image png = png_head(image.size);
  png_alloc_size_t size = 0;
  std::string bytes;
  if (png_image_write_to_memory(&png, nullptr, &size, 0, image.rgba.data(), 0, nullptr)) {
    bytes.resize(size);
    if (png_image_write_to_memory(&png, bytes.data(), &size, 0, image.rgba.data(), 0, nullptr)) return bytes;
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
