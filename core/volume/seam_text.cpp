// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/seam_text.h"

#include <algorithm>
#include <charconv>

#include "core/base/error.h"

namespace limber {

namespace {

[[noreturn]] void fail(const std::string& where) {
  throw Error("the seams in the header are damaged", where, "write the file again with 'limber prepare --seams'");
}

}  // namespace

std::string text_of_seams(const Seams& seams) {
  const glm::ivec3 size = seams.grid_size();
  std::vector<std::int64_t> faces;
  seams.for_each([&](const glm::ivec3& v, int axis) {
    faces.push_back(3 * (v.x + std::int64_t{size.x} * (v.y + std::int64_t{size.y} * v.z)) + axis);
  });
  std::sort(faces.begin(), faces.end());
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  std::int64_t before = 0;
  for (const std::int64_t face : faces) {
    for (auto left = static_cast<std::uint64_t>(face - before);;) {
      const auto byte = static_cast<unsigned>(left & 0x7f) | (left > 0x7f ? 0x80u : 0u);
      text += kDigits[byte >> 4];
      text += kDigits[byte & 15];
      if ((left >>= 7) == 0) break;
    }
    before = face;
  }
  return text;
}

Seams seams_of_text(std::string_view text, const glm::ivec3& grid_size, const std::string& where) {
  Seams seams(grid_size);
  const std::int64_t voxels = std::int64_t{grid_size.x} * grid_size.y * grid_size.z;
  std::int64_t face = 0;
  for (std::size_t at = 0; at < text.size();) {
    std::uint64_t step = 0;
    for (int shift = 0;; shift += 7) {
      unsigned byte = 0;
      if (at + 2 > text.size() || shift > 56) fail(where);
      const auto [end, error] = std::from_chars(text.data() + at, text.data() + at + 2, byte, 16);
      if (error != std::errc() || end != text.data() + at + 2) fail(where);
      at += 2;
      step |= std::uint64_t{byte & 0x7f} << shift;
      if (!(byte & 0x80)) break;
    }
    if (step > static_cast<std::uint64_t>(3 * voxels)) fail(where);
    face += static_cast<std::int64_t>(step);
    if (face >= 3 * voxels) fail(where);
    const std::int64_t place = face / 3;
    const int axis = static_cast<int>(face % 3);
    glm::ivec3 lower(place % grid_size.x, place / grid_size.x % grid_size.y, place / grid_size.x / grid_size.y);
    if (lower[axis] + 1 >= grid_size[axis]) fail(where);
    seams.cut(lower, axis);
  }
  return seams;
}

}  // namespace limber
