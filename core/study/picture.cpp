// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "core/base/deflate.h"
#include "core/study/run_study.h"

namespace limber {

namespace {

constexpr glm::u8vec3 kBackground{0x25, 0x28, 0x2d};
constexpr glm::u8vec3 kPressed{0x2c, 0x5c, 0xa6}, kAsAtRest{0xc9, 0xcd, 0xd4}, kStretched{0xc0, 0x57, 0x2f};
constexpr glm::u8vec3 kTwice{0xff, 0x3e, 0xa5}, kBoneInBone{0xf3, 0xcf, 0x45};
constexpr double kBlock_mm = 16;  // edge of the blocks in which extreme voxels are counted
constexpr double kBeyond = 2;     // a voxel is extreme if its volume ratio is above this or below the inverse of this

glm::u8vec3 mixed(const glm::u8vec3& a, const glm::u8vec3& b, double share) {
  return glm::u8vec3(glm::dvec3(a) + (glm::dvec3(b) - glm::dvec3(a)) * share + 0.5);
}

// Calls put(pixel, voxel) for each pixel of the picture. `voxel` is the index of the voxel at the pixel's position, or
// -1 if this position is outside of the grid.
template <class Put>
void for_each_pixel(const Grid& grid, const PictureFrame& frame, const Put& put) {
  const AffineTransform to_voxel = voxel_from_world(grid);
  const double step = frame.height_mm / frame.size.y;
  for (int y = 0; y < frame.size.y; ++y)
    for (int x = 0; x < frame.size.x; ++x) {
      const glm::dvec3 world = frame.centre + frame.right * ((x + 0.5 - frame.size.x / 2.0) * step) -
                               frame.up * ((y + 0.5 - frame.size.y / 2.0) * step);
      const glm::ivec3 voxel(glm::floor(to_voxel * world + 0.5));
      put(y * frame.size.x + x, grid.contains(voxel) ? grid.index(voxel) : std::int64_t{-1});
    }
}

void put(Picture& picture, int pixel, const glm::u8vec3& colour) {
  for (int c = 0; c < 3; ++c) picture.rgb[3 * pixel + c] = colour[c];
}

std::uint32_t crc_of(const std::string& bytes) {
  static const auto table = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320u ^ (c >> 1) : c >> 1;
      table[n] = c;
    }
    return table;
  }();
  std::uint32_t crc = 0xffffffff;
  for (const char byte : bytes) crc = table[(crc ^ static_cast<std::uint8_t>(byte)) & 0xff] ^ (crc >> 8);
  return ~crc;
}

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

// Returns the given bytes as a chunk of a PNG file: length, name, bytes, and the checksum of name and bytes.
std::string chunk(const std::string& name, const std::string& bytes) {
  return big_endian(static_cast<std::uint32_t>(bytes.size())) + name + bytes + big_endian(crc_of(name + bytes));
}

}  // namespace

LabelColours tissue_colours(const TissueTable& tissues) {
  LabelColours colours(65536, glm::u8vec3(0xb2));
  colours[0] = kBackground;
  for (const Tissue& tissue : tissues.tissues)
    if (tissue.label != 0) colours[tissue.label] = glm::u8vec3(glm::clamp(tissue.colour, 0.0f, 1.0f) * 255.0f + 0.5f);
  return colours;
}

LabelColours ratio_colours() {
  LabelColours colours(65536, kStretched);
  colours[0] = kBackground;
  for (int code = 1; code < 256; ++code) {
    const double doublings = std::clamp(std::log2(ratio_of_code(code)), -1.0, 1.0);
    colours[code] = mixed(kAsAtRest, doublings < 0 ? kPressed : kStretched, std::abs(doublings));
  }
  return colours;
}

Picture slice_picture(const LabelVolume& volume, const LabelColours& colours, const PictureFrame& frame) {
  Picture picture{frame.size, std::vector<std::uint8_t>(std::size_t(frame.size.x) * frame.size.y * 3)};
  for_each_pixel(volume.grid, frame, [&](int pixel, std::int64_t voxel) {
    put(picture, pixel, colours[voxel < 0 ? 0 : volume.voxels[voxel]]);
  });
  return picture;
}

glm::u8vec3 dulled(const glm::u8vec3& colour) {
  const auto grey = static_cast<std::uint8_t>(0.3 * colour.r + 0.59 * colour.g + 0.11 * colour.b);
  return mixed(kBackground, mixed(colour, glm::u8vec3(grey), 0.75), 0.55);
}

Picture marked_picture(const LabelVolume& volume, const LabelVolume& marks, const LabelColours& colours,
                       const PictureFrame& frame) {
  LabelColours dull(colours);
  std::transform(colours.begin() + 1, colours.end(), dull.begin() + 1, dulled);
  Picture picture = slice_picture(volume, dull, frame);
  for_each_pixel(marks.grid, frame, [&](int pixel, std::int64_t voxel) {
    if (voxel >= 0 && marks.voxels[voxel] != 0) put(picture, pixel, marks.voxels[voxel] == 2 ? kBoneInBone : kTwice);
  });
  return picture;
}

std::string png_of(const Picture& picture) {
  std::string packed;
  Deflater deflater(Deflater::Wrap::Zlib,
                    [&](const void* bytes, std::size_t size) { packed.append(static_cast<const char*>(bytes), size); });
  const std::size_t row = std::size_t(picture.size.x) * 3;
  std::string line(row + 1, '\0');
  for (int y = 0; y < picture.size.y; ++y) {
    // Uses PNG's filter 2, which stores each row as differences from the row above, since these compress better than
    // colours.
    line[0] = 2;
    for (std::size_t i = 0; i < row; ++i)
      line[i + 1] = static_cast<char>(picture.rgb[y * row + i] - (y ? picture.rgb[(y - 1) * row + i] : 0));
    deflater.write(line.data(), line.size());
  }
  deflater.end();
  const std::string header =
      // 8 bits per channel, RGB.
      big_endian(picture.size.x) + big_endian(picture.size.y) + std::string("\x08\x02\0\0\0", 5);
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", packed) + chunk("IEND", "");
}

std::optional<WorstRegion> worst_region(const LabelVolume& codes) {
  struct Block {
    std::int64_t beyond = 0, tissue = 0;
    glm::dvec3 sum{0};
    int least = 255, most = 1;
  };
  const Grid& grid = codes.grid;
  const glm::ivec3 step = glm::max(glm::ivec3(glm::round(glm::dvec3(kBlock_mm) / grid.spacing)), glm::ivec3(1));
  std::map<std::tuple<int, int, int>, Block> blocks;  // the blocks that contain tissue, by their index (z, y, x)
  std::int64_t i = 0;
  glm::ivec3 v;
  for (v.z = 0; v.z < grid.size.z; ++v.z)
    for (v.y = 0; v.y < grid.size.y; ++v.y)
      for (v.x = 0; v.x < grid.size.x; ++v.x, ++i) {
        const int code = codes.voxels[i];
        if (code == 0) continue;
        const glm::ivec3 b = v / step;
        Block& block = blocks[{b.z, b.y, b.x}];
        ++block.tissue;
        block.least = std::min(block.least, code);
        block.most = std::max(block.most, code);
        if (const double ratio = ratio_of_code(code); ratio > kBeyond || ratio < 1 / kBeyond)
          ++block.beyond, block.sum += glm::dvec3(v);
      }
  std::optional<WorstRegion> worst;
  for (const auto& [at, middle] : blocks) {
    if (middle.beyond == 0) continue;
    Block all;
    const auto [z, y, x] = at;
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          if (const auto found = blocks.find({z + dz, y + dy, x + dx}); found != blocks.end()) {
            const Block& one = found->second;
            all.beyond += one.beyond, all.tissue += one.tissue, all.sum += one.sum;
            all.least = std::min(all.least, one.least), all.most = std::max(all.most, one.most);
          }
    if (worst && all.beyond <= worst->voxels) continue;
    worst = {world_from_voxel(grid) * (all.sum / double(all.beyond)), all.beyond, all.tissue, ratio_of_code(all.least),
             ratio_of_code(all.most)};
  }
  return worst;
}

}  // namespace limber
