// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/picture.h"

#include <cmath>

#include <doctest/doctest.h>
#include <zlib.h>

#include "core/study/run_study.h"
#include "tests/support/bent_tube.h"

using namespace limber;

namespace {

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<std::uint8_t>(bytes[at + k]);
  return value;
}

// Decodes a PNG file by zlib, and checks its checksums.
Picture decoded(const std::string& png) {
  REQUIRE(png.substr(0, 8) == "\x89PNG\r\n\x1a\n");
  Picture picture;
  std::string packed;
  for (std::size_t at = 8; at < png.size();) {
    const std::uint32_t length = number_at(png, at);
    const std::string name = png.substr(at + 4, 4), bytes = png.substr(at + 8, length), checked = name + bytes;
    CHECK(number_at(png, at + 8 + length) ==
          crc32(0, reinterpret_cast<const Bytef*>(checked.data()), static_cast<uInt>(checked.size())));
    if (name == "IHDR") picture.size = {number_at(bytes, 0), number_at(bytes, 4)};
    if (name == "IDAT") packed += bytes;
    at += 12 + length;
  }
  const std::size_t row = std::size_t(picture.size.x) * 3;
  std::vector<std::uint8_t> lines(std::size_t(picture.size.y) * (row + 1));
  uLongf made = lines.size();
  REQUIRE(uncompress(lines.data(), &made, reinterpret_cast<const Bytef*>(packed.data()), packed.size()) == Z_OK);
  REQUIRE(made == lines.size());
  for (int y = 0; y < picture.size.y; ++y) {
    const std::uint8_t* line = lines.data() + std::size_t(y) * (row + 1);
    REQUIRE(line[0] == 2);
    for (std::size_t i = 0; i < row; ++i)
      picture.rgb.push_back(
          static_cast<std::uint8_t>(line[i + 1] + (y ? picture.rgb[std::size_t(y - 1) * row + i] : 0)));
  }
  return picture;
}

}  // namespace

TEST_CASE("study pictures: a PNG file holds the picture's pixels") {
  Picture picture{{37, 21}, {}};
  for (int i = 0; i < 37 * 21 * 3; ++i) picture.rgb.push_back(static_cast<std::uint8_t>(i * i / 7));
  const Picture read = decoded(png_of(picture));
  CHECK(read.size == picture.size);
  CHECK(read.rgb == picture.rgb);
}

TEST_CASE("study pictures: a slice shows the voxel that each pixel lies in, on turned and mirrored grids too") {
  for (const Grid& grid : {Grid{}, test::oblique_grid()}) {
    LabelVolume volume{grid, {}};
    volume.grid.size = {9, 8, 7};
    for (std::int64_t i = 0; i < volume.grid.voxel_count(); ++i) volume.voxels.push_back(static_cast<Label>(i % 5));
    LabelColours colours(65536);
    for (int label = 0; label < 5; ++label) colours[label] = glm::u8vec3(50 * label, 255 - 50 * label, label);
    const AffineTransform to_world = world_from_voxel(volume.grid);
    // The view looks along the grid's z: one pixel per voxel of the slice z = 4, with rows running against y.
    const PictureFrame frame{.centre = to_world * glm::dvec3(4, 3.5, 4),
                             .right = volume.grid.direction[0],
                             .up = volume.grid.direction[1],
                             .height_mm = 8 * volume.grid.spacing.y,
                             .size = {9, 8}};
    const Picture picture = slice_picture(volume, colours, frame);
    if (volume.grid.spacing.x == volume.grid.spacing.y)
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 9; ++x) {
          const Label label = volume.at({x, 7 - y, 4});
          CHECK(glm::u8vec3(picture.rgb[3 * (9 * y + x)], picture.rgb[3 * (9 * y + x) + 1],
                            picture.rgb[3 * (9 * y + x) + 2]) == colours[label]);
        }
    const std::size_t middle = 3 * (9 * 4 + 4);  // the pixel just below the centre
    CHECK(glm::u8vec3(picture.rgb[middle], picture.rgb[middle + 1], picture.rgb[middle + 2]) ==
          colours[volume.at({4, 3, 4})]);
  }
}

TEST_CASE(
    "study pictures: volume ratios keep their size within 2.2 % in a byte, and the worst region lies where most voxels "
    "are beyond two") {
  for (const double ratio : {0.02, 0.1, 0.5, 0.97, 1.0, 1.3, 2.0, 7.5, 50.0})
    CHECK(std::abs(ratio_of_code(code_of_ratio(ratio)) / ratio - 1) < 0.0221);
  CHECK(ratio_of_code(code_of_ratio(1)) == 1);
  CHECK(code_of_ratio(-3) == 1);
  CHECK(code_of_ratio(1e9) == 255);

  LabelVolume codes{{.size = {60, 60, 60}, .spacing = glm::dvec3(2), .origin = {5, 6, 7}}, {}};
  codes.voxels.assign(codes.grid.voxel_count(), code_of_ratio(1));
  CHECK_FALSE(worst_region(codes).has_value());
  for (int z = 30; z < 34; ++z)
    for (int y = 30; y < 34; ++y)
      for (int x = 30; x < 34; ++x) codes.at({x, y, z}) = code_of_ratio(0.25);
  for (int x = 0; x < 20; ++x) codes.at({x, 3, 3}) = code_of_ratio(4);
  const auto worst = worst_region(codes);
  REQUIRE(worst);
  CHECK(worst->voxels == 64);
  CHECK(glm::distance(worst->centre, glm::dvec3(5, 6, 7) + 2.0 * 31.5) < 1e-9);
  CHECK(worst->least == doctest::Approx(0.25));
  CHECK(worst->most == 1);
  CHECK(worst->of == 24 * 24 * 24);
}
