// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/resample/rest_points.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>

#include "core/platform/memory_pages.h"

namespace limber {

namespace {

// Edge of a block of voxels whose rest points are computed at once. Callers mostly ask for many points close together.
constexpr int kBlock = 8;
// Number of rest points of a block that are computed one by one. The next request computes the whole block.
constexpr int kMany = 3;

static_assert(RestPoints::kTile.x <= 64, "a row's tissue is the bits of one word");

// Returns a word whose bit x is 1 if the map's voxel at index first + x has tissue, for x below `count` (at most 64).
std::uint64_t covered_bits(const InverseMap& map, std::int64_t first, std::int64_t count) {
  std::array<std::uint8_t, 64> covered{};
  for (std::int64_t x = 0; x < count; ++x) covered[x] = map.is_covered(first + x);
  std::uint64_t bits = 0;
  for (int byte = 0; byte < 8; ++byte) {
    std::uint64_t eight;
    std::memcpy(&eight, &covered[8 * byte], sizeof eight);
    bits |= (eight * 0x0102040810204080 >> 56) << (8 * byte);  // packs the lowest bits of eight bytes into one byte
  }
  return bits;
}

}  // namespace

RestPoints::RestPoints(const VoxelRange& output, std::int64_t room, Trace trace)
    : output_(output),
      tile_count_((output.high - output.low + kTile) / kTile),
      trace_(std::move(trace)),
      room_(room),
      points_(std::make_unique_for_overwrite<glm::vec3[]>(room)),
      tiles_(std::int64_t{tile_count_.x} * tile_count_.y * tile_count_.z) {
  want_large_pages(points_.get(), room * std::int64_t{sizeof(glm::vec3)});
}

std::int64_t RestPoints::tile_at(const glm::ivec3& voxel) const {
  const glm::ivec3 tile = voxel / kTile;
  return tile.x + std::int64_t{tile_count_.x} * (tile.y + std::int64_t{tile_count_.y} * tile.z);
}

void RestPoints::keep(const InverseMap& map) {
  if (used_.load() >= room_) return;
  const std::int64_t length = map.range.high.x - map.range.low.x + 1;
  std::vector<Row> rows(map.row_used.size());
  std::int64_t count = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (!map.row_used[r]) continue;
    rows[r] = {covered_bits(map, r * length, length), count};
    count += std::popcount(rows[r].has_tissue);
  }
  std::int64_t first = used_.load();
  do
    if (first + count > room_) return;
  while (!used_.compare_exchange_weak(first, first + count));
  glm::vec3* point = &points_[first];
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows[r].first += first;
    for (std::uint64_t bits = rows[r].has_tissue; bits; bits &= bits - 1)
      *point++ = map.rest[r * length + std::countr_zero(bits)];
  }
  tiles_[tile_at(map.range.low - output_.low)] = std::move(rows);
}

glm::dvec3 RestPoints::at(const glm::ivec3& voxel) {
  const std::vector<Row>& tile = tiles_[tile_at(voxel)];
  return glm::dvec3(tile.empty() ? traced(voxel) : kept(tile, voxel));
}

glm::vec3 RestPoints::kept(const std::vector<Row>& tile, const glm::ivec3& voxel) const {
  const glm::ivec3 low = voxel / kTile * kTile, in = voxel - low;
  const int height = std::min(kTile.y, output_.high.y - output_.low.y + 1 - low.y);
  const Row& row = tile[in.y + std::int64_t{height} * in.z];
  if (!(row.has_tissue >> in.x & 1)) return glm::vec3(0);
  return points_[row.first + std::popcount(row.has_tissue & ((std::uint64_t{1} << in.x) - 1))];
}

glm::vec3 RestPoints::traced(const glm::ivec3& voxel) {
  const glm::ivec3 first = voxel / kBlock * kBlock, size = output_.high - output_.low + 1;
  Block& block = blocks_[first.x + std::int64_t{size.x} * (first.y + std::int64_t{size.y} * first.z)];
  if (block.rest.empty() && block.asked++ < kMany) return trace_all({output_.low + voxel, output_.low + voxel})[0];
  const glm::ivec3 low = output_.low + first, high = glm::min(low + kBlock - 1, output_.high);
  const glm::ivec3 in = voxel - first, extent = high - low + 1;
  if (block.rest.empty()) block.rest = trace_all({low, high});
  return block.rest[in.x + std::size_t(extent.x) * (in.y + std::size_t(extent.y) * in.z)];
}

// Returns the rest points of all voxels of a range, x fastest; the zero vector where there is no tissue.
std::vector<glm::vec3> RestPoints::trace_all(const VoxelRange& range) const {
  InverseMap map;
  map.has_volume_ratio = false;
  trace_(map, range);
  const glm::ivec3 size = range.high - range.low + 1;
  std::vector<glm::vec3> rest(std::size_t(size.x) * size.y * size.z, glm::vec3(0));
  for (std::size_t i = 0; i < map.rest.size(); ++i)
    if (map.is_covered(static_cast<std::int64_t>(i))) rest[i] = map.rest[i];
  return rest;
}

}  // namespace limber
