// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/project/seams_codec.h"

#include <algorithm>
#include <array>
#include <vector>

namespace limber {

namespace {

constexpr std::int32_t kLongestAxis = 1 << 20;

std::int64_t index_in(const glm::ivec3& size, const glm::ivec3& v) {
  return v.x + std::int64_t{size.x} * (v.y + std::int64_t{size.y} * v.z);
}

}  // namespace

void put(ByteWriter& out, const Seams& seams) {
  const glm::ivec3 size = seams.grid_size();
  for (int i = 0; i < 3; ++i) out.put(static_cast<std::int32_t>(size[i]));
  std::array<std::vector<std::int64_t>, 3> faces;
  seams.for_each([&](const glm::ivec3& lower, int axis) { faces[axis].push_back(index_in(size, lower)); });
  for (auto& of_axis : faces) {
    std::sort(of_axis.begin(), of_axis.end());
    out.count(of_axis.size());
    out.raw(of_axis.data(), of_axis.size() * sizeof(std::int64_t));
  }
}

Seams get_seams(ByteReader& in, const std::function<void(std::int64_t)>& take_memory) {
  glm::ivec3 size;
  for (int i = 0; i < 3; ++i) size[i] = static_cast<int>(in.get_below<std::uint32_t>(kLongestAxis + 1));
  const std::int64_t slice = std::int64_t{size.x} * size.y;  // voxels of a slice, at most 2^40
  in.require(slice == 0 || size.z <= (std::int64_t{1} << 42) / slice);
  const glm::ivec3 bricks = (size + 7) / 8;
  take_memory(std::int64_t{bricks.x} * bricks.y * bricks.z * std::int64_t{sizeof(std::int32_t)});
  Seams seams(size);
  for (int axis = 0; axis < 3; ++axis) {
    std::int64_t last = -1;
    for (std::size_t count = in.count(sizeof(std::int64_t)); count > 0; --count) {
      const auto index = in.get<std::int64_t>();
      in.require(index > last && index < slice * size.z);
      last = index;
      const glm::ivec3 lower(index % size.x, index / size.x % size.y, index / slice);
      in.require(lower[axis] + 1 < size[axis]);
      seams.cut(lower, axis);
    }
  }
  return seams;
}

bool fit(const Seams& seams, const LabelVolume& volume) {
  if (seams.grid_size() != volume.grid.size) return false;
  bool between_tissue = true;
  seams.for_each([&](const glm::ivec3& lower, int axis) {
    glm::ivec3 upper = lower;
    ++upper[axis];
    between_tissue = between_tissue && volume.at(lower) != 0 && volume.at_or_air(upper) != 0;
  });
  return between_tissue;
}

}  // namespace limber
