// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/paint/brush_region.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace limber {

namespace {

constexpr int kBrick = TissueVoxels::kBrick;
constexpr float kFar = std::numeric_limits<float>::infinity();
// A geodesic dab whose centre is more than this many voxels from tissue along an axis touches nothing.
constexpr int kMostBeside = 2;

// Returns the number of set bits. It does not use the processor's instruction, because the program must run on the few
// machines that lack it. (The last sums use shifts: compilers recognize the usual multiplication and would call a
// function.)
int bit_count(std::uint64_t word) {
  word -= word >> 1 & 0x5555555555555555u;
  word = (word & 0x3333333333333333u) + (word >> 2 & 0x3333333333333333u);
  word = (word + (word >> 4)) & 0x0f0f0f0f0f0f0f0fu;
  word += word >> 32;
  word += word >> 16;
  word += word >> 8;
  return static_cast<int>(word & 0x7f);
}

std::uint64_t reversed(std::uint64_t word) {
  word = (word >> 1 & 0x5555555555555555u) | (word & 0x5555555555555555u) << 1;
  word = (word >> 2 & 0x3333333333333333u) | (word & 0x3333333333333333u) << 2;
  word = (word >> 4 & 0x0f0f0f0f0f0f0f0fu) | (word & 0x0f0f0f0f0f0f0f0fu) << 4;
  word = (word >> 8 & 0x00ff00ff00ff00ffu) | (word & 0x00ff00ff00ff00ffu) << 8;
  word = (word >> 16 & 0x0000ffff0000ffffu) | (word & 0x0000ffff0000ffffu) << 16;
  return word >> 32 | word << 32;
}

// Returns 64 bits of a row of `words` words from bit `from` on, which may be negative. Bits outside the row are 0.
std::uint64_t bits_from(const std::uint64_t* row, int words, int from) {
  const int word = from >> 6, shift = from & 63;
  const auto at = [&](int w) { return w >= 0 && w < words ? row[w] : 0; };
  return shift == 0 ? at(word) : at(word) >> shift | at(word + 1) << (64 - shift);
}

// Returns the position of the first set bit at or after `from`, or words * 64 when there is none.
int next_set(const std::uint64_t* row, int words, int from) {
  for (int w = from >> 6; w < words; ++w) {
    const std::uint64_t left = w == from >> 6 ? row[w] & ~std::uint64_t{0} << (from & 63) : row[w];
    if (left) return w * 64 + std::countr_zero(left);
  }
  return words * 64;
}

int next_clear(const std::uint64_t* row, int words, int from) {
  for (int w = from >> 6; w < words; ++w) {
    const std::uint64_t left = w == from >> 6 ? ~row[w] & ~std::uint64_t{0} << (from & 63) : ~row[w];
    if (left) return w * 64 + std::countr_zero(left);
  }
  return words * 64;
}

void set_range(std::uint64_t* row, int begin, int end) {
  for (; begin < end && (begin & 63); ++begin) row[begin >> 6] |= std::uint64_t{1} << (begin & 63);
  for (; begin + 64 <= end; begin += 64) row[begin >> 6] = ~std::uint64_t{0};
  if (begin < end) row[begin >> 6] |= (std::uint64_t{1} << (end - begin)) - 1;
}

// Returns word number `word` of a row of bits in which the bits at the positions 0 to `end`, both included, are set.
std::uint64_t up_to(int end, int word) {
  const int left = end - word * 64;
  return left < 0 ? 0 : left >= 63 ? ~std::uint64_t{0} : (std::uint64_t{2} << left) - 1;
}

// Fills rows of bits for slice low.z: a bit is 1 where there is no tissue, and outside the volume. The first bit is the
// bit of voxel `low`, whose x must be a multiple of eight.
void air_of_slice(const TissueVoxels& tissue, const glm::ivec3& low, int words, int rows, std::uint64_t* air) {
  std::fill_n(air, std::size_t(words) * rows, ~std::uint64_t{0});
  if (low.z < 0 || low.z >= tissue.grid_size().z) return;
  for (int y = std::max(low.y, 0) & ~(kBrick - 1); y < std::min(low.y + rows, tissue.grid_size().y); y += kBrick)
    for (int x = std::max(low.x, 0); x < std::min(low.x + 64 * words, tissue.grid_size().x); x += kBrick) {
      const int brick = tissue.brick_at({x, y, low.z});
      if (brick < 0) continue;
      const std::uint64_t mask = tissue.bricks()[brick].mask[low.z & (kBrick - 1)];
      const int bit = x - low.x;
      for (int r = std::max(y, low.y), end = std::min(y + kBrick, low.y + rows); r < end; ++r)
        air[std::size_t(words) * (r - low.y) + (bit >> 6)] &= ~((mask >> (8 * (r - y)) & 0xff) << (bit & 63));
    }
}

}  // namespace

BrushReach::BrushReach(const LabelVolume& volume, const TissueVoxels& tissue, BrushFilter filter)
    : volume_(volume),
      tissue_(tissue),
      filter_(std::move(filter)),
      voxel_from_world_(voxel_from_world(volume.grid)) {
  filtered_ =
      !filter_.labels.empty() || filter_.box || filter_.plane || filter_.depth != BrushDepth::Through || filter_.allows;
  if (filtered_) allowed_of_.assign(tissue.bricks().size(), -1);
}

// ---- The window: the box of voxels around a dab

// Finds the tissue voxel nearest to the dab's centre. Searches the surfaces of larger and larger cubes around the
// centre. After the first hit it searches one more cube, because the hit may lie at a corner of its cube. Returns false
// when there is no tissue voxel within kMostBeside.
bool BrushReach::find_start() {
  const glm::dvec3 nearest = glm::round(centre_), size(tissue_.grid_size());
  if (glm::any(glm::lessThan(nearest, glm::dvec3(-kMostBeside))) ||
      glm::any(glm::greaterThan(nearest, size + double(kMostBeside))))
    return false;
  const glm::ivec3 middle(nearest);
  double best = 1e300;
  int last = kMostBeside;
  for (int reach = 0; reach <= last; ++reach)
    for (int z = -reach; z <= reach; ++z)
      for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x) {
          const glm::ivec3 v = middle + glm::ivec3(x, y, z);
          if (std::max({std::abs(x), std::abs(y), std::abs(z)}) != reach || !volume_.grid.contains(v) ||
              tissue_.index_of(v) < 0)
            continue;
          const glm::dvec3 way = (glm::dvec3(v) - centre_) * volume_.grid.spacing;
          if (glm::dot(way, way) >= best) continue;
          best = glm::dot(way, way);
          start_ = v;
          last = std::min(last, reach + 1);
        }
  return best < 1e300;
}

bool BrushReach::place_window(double radius, bool grown) {
  const glm::dvec3 reach = radius / volume_.grid.spacing, last(tissue_.grid_size() - 1);
  glm::dvec3 low = glm::ceil(centre_ - reach), high = glm::floor(centre_ + reach);
  if (grown) {
    low = glm::min(low - 1.0, glm::dvec3(start_));
    high = glm::max(high + 1.0, glm::dvec3(start_));
  }
  low = glm::max(low, glm::dvec3(0));
  high = glm::min(high, last);
  if (!glm::all(glm::lessThanEqual(low, high))) return false;
  low_ = glm::ivec3(low);
  size_ = glm::ivec3(high) - low_ + 1;
  for (int axis = 0; axis < 3; ++axis) {
    squared_[axis].resize(size_[axis] + 2 * kBrick);
    // The lists in squared_ extend one brick beyond the window, since bricks at the window's rim do so too.
    for (int i = -kBrick; i < size_[axis] + kBrick; ++i) {
      const double way = (low_[axis] + i - centre_[axis]) * volume_.grid.spacing[axis];
      squared_[axis][i + kBrick] = static_cast<float>(way * way);
    }
  }
  bricks_.clear();
  const glm::ivec3 first = low_ / kBrick, end = (low_ + size_ - 1) / kBrick;
  for (int z = first.z; z <= end.z; ++z)
    for (int y = first.y; y <= end.y; ++y)
      for (int x = first.x; x <= end.x; ++x)
        if (const int brick = tissue_.brick_at(glm::ivec3(x, y, z) * kBrick); brick >= 0) bricks_.push_back(brick);
  return true;
}

void BrushReach::place_ball(double radius, std::vector<Span>& ball) const {
  ball.resize(std::size_t(size_.y) * size_.z);
  const glm::dvec3 spacing = volume_.grid.spacing;
  auto row = ball.begin();
  for (int z = 0; z < size_.z; ++z) {
    const double dz = (low_.z + z - centre_.z) * spacing.z;
    for (int y = 0; y < size_.y; ++y, ++row) {
      const double dy = (low_.y + y - centre_.y) * spacing.y, left = radius * radius - dz * dz - dy * dy;
      if (left < 0) {
        *row = {1, 0};
        continue;
      }
      // Limits the row's span to the window. Rounds by truncation, because std::ceil would be a slow function call.
      const double half = std::sqrt(left) / spacing.x, first = std::max(centre_.x - half - low_.x, 0.0);
      const double last = std::min(centre_.x + half - low_.x, size_.x - 1.0);
      const int cut = static_cast<int>(std::min(first, 1.0 * size_.x));
      *row = {low_.x + cut + (first > cut), last < 0 ? low_.x - 1 : low_.x + static_cast<int>(last)};
    }
  }
}

std::uint64_t BrushReach::ball_word(const std::vector<Span>& ball, const glm::ivec3& corner, int z) const {
  const int row_z = corner.z + z - low_.z;
  if (row_z < 0 || row_z >= size_.z) return 0;
  const Span* rows = &ball[std::size_t(row_z) * size_.y];
  std::uint64_t word = 0;
  for (int y = std::max(0, low_.y - corner.y), end = std::min(kBrick, low_.y + size_.y - corner.y); y < end; ++y) {
    const Span& row = rows[corner.y + y - low_.y];
    // The bits of those voxels of the span that lie in the brick. No bit is left when the span lies beside the brick.
    const int first = std::clamp(row.first - corner.x, 0, kBrick),
              behind = std::clamp(corner.x + kBrick - 1 - row.last, 0, kBrick);
    word |= std::uint64_t{(0xffu << first) & (0xffu >> behind)} << (8 * y);
  }
  return word;
}

std::uint64_t BrushReach::window_word(const std::vector<std::uint64_t>& rows, const glm::ivec3& corner, int z) const {
  const int row_z = corner.z + z - low_.z;
  if (row_z < 0 || row_z >= size_.z) return 0;
  const int bit = corner.x - x0_;
  const std::uint64_t* row = &rows[std::size_t(row_z) * size_.y * words_ + (bit >> 6)];
  std::uint64_t word = 0;
  for (int y = std::max(0, low_.y - corner.y), end = std::min(kBrick, low_.y + size_.y - corner.y); y < end; ++y)
    word |= (row[std::ptrdiff_t(corner.y + y - low_.y) * words_] >> (bit & 63) & 0xff) << (8 * y);
  return word;
}

// ---- The voxels that may change

void BrushReach::need_allowed() {
  std::vector<int> fresh;
  for (const int brick : bricks_)
    if (allowed_of_[brick] < 0) {
      allowed_of_[brick] = static_cast<std::int32_t>(allowed_.size());
      allowed_.push_back(allowed_by_filter(brick));
      fresh.push_back(brick);
    }
  if (filter_.depth == BrushDepth::ToDepth)
    // Handles one layer of bricks at a time, so that little memory is needed.
    for (std::size_t begin = 0, end; begin < fresh.size(); begin = end) {
      const int z = tissue_.bricks()[fresh[begin]].corner.z;
      for (end = begin; end < fresh.size() && tissue_.bricks()[fresh[end]].corner.z == z; ++end) {
      }
      keep_shallow(std::span(fresh).subspan(begin, end - begin));
    }
}

BrushReach::Mask BrushReach::allowed_by_filter(int index) const {
  const TissueVoxels::Brick& brick = tissue_.bricks()[index];
  Mask mask = filter_.depth == BrushDepth::Surface ? surface_of(index) : brick.mask;
  if (filter_.labels.empty() && !filter_.box && !filter_.plane && !filter_.allows) return mask;
  const AffineTransform world = world_from_voxel(volume_.grid);
  std::int64_t place = brick.first;
  for (int z = 0; z < kBrick; ++z)
    for (std::uint64_t word = brick.mask[z]; word; word &= word - 1, ++place) {
      const int bit = std::countr_zero(word);
      if (!(mask[z] >> bit & 1)) continue;
      const glm::ivec3 v = brick.corner + glm::ivec3(bit & 7, bit >> 3, z);
      bool allowed = filter_.labels.empty() || (volume_.at(v) < filter_.labels.size() && filter_.labels[volume_.at(v)]);
      if (allowed && filter_.box)
        allowed = glm::all(glm::greaterThanEqual(glm::dvec3(v), filter_.box->low)) &&
                  glm::all(glm::lessThanEqual(glm::dvec3(v), filter_.box->high));
      if (allowed && filter_.plane)
        allowed = glm::dot(world * glm::dvec3(v) - filter_.plane->point, filter_.plane->normal) <= 0;
      if (allowed && filter_.allows) allowed = filter_.allows(place, v);
      if (!allowed) mask[z] &= ~(std::uint64_t{1} << bit);
    }
  return mask;
}

BrushReach::Mask BrushReach::surface_of(int index) const {
  constexpr std::uint64_t kFirstColumn = 0x0101010101010101u;
  const TissueVoxels::Brick& brick = tissue_.bricks()[index];
  const auto mask_beside = [&](int axis, int side) -> Mask {
    glm::ivec3 v = brick.corner;
    v[axis] += side * kBrick;
    if (!volume_.grid.contains(v)) return {};
    const int beside = tissue_.brick_at(v);
    return beside < 0 ? Mask{} : tissue_.bricks()[beside].mask;
  };
  const Mask &own = brick.mask, left = mask_beside(0, -1), right = mask_beside(0, 1), front = mask_beside(1, -1),
             back = mask_beside(1, 1), below = mask_beside(2, -1), above = mask_beside(2, 1);
  Mask surface;
  for (int z = 0; z < kBrick; ++z) {
    const std::uint64_t inside = (((own[z] << 1) & ~kFirstColumn) | ((left[z] >> 7) & kFirstColumn)) &
                                 (((own[z] >> 1) & ~(kFirstColumn << 7)) | ((right[z] & kFirstColumn) << 7)) &
                                 (own[z] << 8 | front[z] >> 56) & (own[z] >> 8 | back[z] << 56) &
                                 (z > 0 ? own[z - 1] : below[7]) & (z < 7 ? own[z + 1] : above[0]);
    surface[z] = own[z] & ~inside;
  }
  return surface;
}

// Removes voxels from `allowed_` that lie deeper than depth_mm below the air: dilates the air by a ball of that radius.
// The air is stored as rows of bits in a box around the bricks. Each slice of air is dilated along x by every half
// width of the ball. Each result is then added to those rows around it in which the ball has that half width.
void BrushReach::keep_shallow(std::span<const int> bricks) {
  const glm::dvec3 spacing = volume_.grid.spacing;
  const glm::ivec3 margin(glm::min(glm::floor(filter_.depth_mm / spacing + 1e-9), glm::dvec3(volume_.grid.size)));
  glm::ivec3 low(std::numeric_limits<int>::max()), high(0);
  for (const int brick : bricks) {
    low = glm::min(low, tissue_.bricks()[brick].corner);
    high = glm::max(high, tissue_.bricks()[brick].corner + kBrick - 1);
  }
  const int from_x = (low.x - margin.x) & ~(kBrick - 1), words = (high.x + margin.x - from_x) / 64 + 1;
  const int rows = high.y - low.y + 1, air_rows = rows + 2 * margin.y;
  // The ball's half width along x, in voxels, in the row that lies y and z voxels from its centre; -1 for a row that
  // the ball does not reach.
  const float most = static_cast<float>(filter_.depth_mm * filter_.depth_mm * (1 + 1e-6));
  const auto squared = [&](int axis, int steps) {
    return static_cast<float>(steps * spacing[axis] * steps * spacing[axis]);
  };
  std::vector<int> reach(std::size_t(margin.y + 1) * (margin.z + 1), -1);
  for (int z = 0; z <= margin.z; ++z)
    for (int y = 0; y <= margin.y; ++y)
      for (int x = 0; x <= margin.x; ++x) {
        const float way = static_cast<float>(x * spacing.x);
        if (way * way + squared(1, y) + squared(2, z) <= most) reach[y + (margin.y + 1) * z] = x;
      }
  std::vector<std::uint64_t> shallow(std::size_t(words) * rows * kBrick, 0),
      grown(std::size_t(words) * air_rows * (margin.x + 1));
  for (int z = low.z - margin.z; z < low.z + kBrick + margin.z; ++z) {
    air_of_slice(tissue_, {from_x, low.y - margin.y, z}, words, air_rows, grown.data());
    for (int width = 1; width <= margin.x; ++width) {
      const std::uint64_t* last = &grown[std::size_t(words) * air_rows * (width - 1)];
      std::uint64_t* next = &grown[std::size_t(words) * air_rows * width];
      for (int r = 0; r < air_rows; ++r, last += words, next += words)
        for (int w = 0; w < words; ++w)
          next[w] = last[w] | last[w] << 1 | last[w] >> 1 | (w > 0 ? last[w - 1] >> 63 : 0) |
                    (w + 1 < words ? last[w + 1] << 63 : 0);
    }
    for (int to = std::max(0, z - margin.z - low.z), end = std::min(kBrick - 1, z + margin.z - low.z); to <= end;
         ++to) {
      std::uint64_t* into = &shallow[std::size_t(words) * rows * to];
      for (int y = -margin.y; y <= margin.y; ++y) {
        const int width = reach[std::abs(y) + (margin.y + 1) * std::abs(low.z + to - z)];
        if (width < 0) continue;
        const std::uint64_t* air = &grown[std::size_t(words) * (std::size_t(air_rows) * width + margin.y + y)];
        for (std::ptrdiff_t i = 0, count = std::ptrdiff_t{words} * rows; i < count; ++i) into[i] |= air[i];
      }
    }
  }
  for (const int brick : bricks) {
    const TissueVoxels::Brick& b = tissue_.bricks()[brick];
    const Mask surface = surface_of(brick);
    Mask& mask = allowed_[allowed_of_[brick]];
    const int bit = b.corner.x - from_x;
    for (int z = 0; z < kBrick; ++z) {
      std::uint64_t near = 0;
      const std::uint64_t* row =
          &shallow[std::size_t(words) * (std::size_t(rows) * z + b.corner.y - low.y) + (bit >> 6)];
      for (int y = 0; y < kBrick; ++y, row += words) near |= (*row >> (bit & 63) & 0xff) << (8 * y);
      mask[z] &= surface[z] | near;
    }
  }
}

// ---- The voxels in sight: the straight line between each of them and the start voxel lies in tissue.

void BrushReach::gather_tissue() {
  x0_ = low_.x & ~(kBrick - 1);
  words_ = (low_.x + size_.x - 1 - x0_) / 64 + 1;
  tissue_rows_.assign(std::size_t(words_) * size_.y * size_.z, 0);
  for (const int index : bricks_) {
    const TissueVoxels::Brick& brick = tissue_.bricks()[index];
    const int bit = brick.corner.x - x0_;
    for (int z = std::max(0, low_.z - brick.corner.z), end_z = std::min(kBrick, low_.z + size_.z - brick.corner.z);
         z < end_z; ++z) {
      const std::uint64_t word = brick.mask[z] & ball_word(grown_ball_, brick.corner, z);
      if (!word) continue;
      std::uint64_t* row = &tissue_rows_[(std::size_t(brick.corner.z + z - low_.z) * size_.y) * words_ + (bit >> 6)];
      for (int y = std::max(0, low_.y - brick.corner.y), end = std::min(kBrick, low_.y + size_.y - brick.corner.y);
           y < end; ++y)
        row[std::ptrdiff_t(brick.corner.y + y - low_.y) * words_] |= (word >> (8 * y) & 0xff) << (bit & 63);
    }
  }
}

const Seams* BrushReach::seams_near() const {
  const Seams* seams = tissue_.seams();
  const auto is_near = [&](int brick) { return seams->is_near_brick(tissue_.bricks()[brick].corner); };
  return seams && std::any_of(bricks_.begin(), bricks_.end(), is_near) ? seams : nullptr;
}

// Marks only the start voxel as seen. Near a seam, the front of shortest paths finds all other voxels from it.
void BrushReach::see_start() {
  const glm::ivec3 cell = start_ - low_;
  const int bit = start_.x - x0_;
  seen_rows_[(std::size_t(cell.z) * size_.y + cell.y) * words_ + (bit >> 6)] |= std::uint64_t{1} << (bit & 63);
}

// Finds the voxels in sight in one half of the window: at or above the x of the start voxel (side 1), or at or below it
// (side -1).
void BrushReach::see(int side) {
  const glm::ivec3 start = start_ - low_;
  const int from = start_.x - x0_, rows = size_.y * size_.z;
  half_words_ = (side > 0 ? size_.x - 1 - start.x : start.x) / 64 + 1;
  half_tissue_.resize(std::size_t(rows) * half_words_);
  half_seen_.assign(std::size_t(rows) * half_words_, 0);
  certain_.resize(half_words_);
  possible_.resize(half_words_);
  for (int r = 0; r < rows; ++r)
    for (int w = 0; w < half_words_; ++w) {
      const std::uint64_t* row = &tissue_rows_[std::size_t(r) * words_];
      half_tissue_[std::size_t(r) * half_words_ + w] =
          side > 0 ? bits_from(row, words_, from + 64 * w) : reversed(bits_from(row, words_, from - 64 * w - 63));
    }
  const int most_y = std::max(start.y, size_.y - 1 - start.y), most_z = std::max(start.z, size_.z - 1 - start.z);
  for (int z = 0; z <= most_z; ++z)
    for (const int side_z : {1, -1}) {
      if ((z == 0 && side_z < 0) || start.z + side_z * z < 0 || start.z + side_z * z >= size_.z) continue;
      for (int y = 0; y <= most_y; ++y)
        for (const int side_y : {1, -1}) {
          if ((y == 0 && side_y < 0) || start.y + side_y * y < 0 || start.y + side_y * y >= size_.y) continue;
          see_row(side, side_y * y, side_z * z);
        }
    }
  for (int r = 0; r < rows; ++r) {
    std::uint64_t* row = &seen_rows_[std::size_t(r) * words_];
    const std::uint64_t* half = &half_seen_[std::size_t(r) * half_words_];
    for (int w = 0; w < words_; ++w)
      row[w] |= side > 0 ? bits_from(half, half_words_, 64 * w - from)
                         : reversed(bits_from(half, half_words_, from - 64 * w - 63));
  }
}

// Finds the voxels in sight in the row at offset (y, z) from the start voxel. The line of sight to a voxel passes
// between four voxels that are one step nearer to the start along the line's longest axis. The voxel is in sight when
// all four are in sight, and not when none is. In all other cases, the line is walked voxel by voxel.
void BrushReach::see_row(int side, int y, int z) {
  const glm::ivec3 start = start_ - low_;
  const auto row_of = [&](int dy, int dz) {
    return std::size_t(start.y + dy + size_.y * (start.z + dz)) * half_words_;
  };
  const std::uint64_t* tissue = &half_tissue_[row_of(y, z)];
  std::uint64_t* seen = &half_seen_[row_of(y, z)];
  if (y == 0 && z == 0) {
    set_range(seen, 0, next_clear(tissue, half_words_, 0));
    return;
  }
  const int near_y = y == 0 ? 0 : y > 0 ? y - 1 : y + 1, near_z = z == 0 ? 0 : z > 0 ? z - 1 : z + 1;
  // The rows of seen voxels that are one step nearer to the start in y, in z, and in both. In the planes y = 0 and z =
  // 0 through the start, one of these rows does not exist, so another one of them is used instead.
  const std::uint64_t* in_y = &half_seen_[y == 0 ? row_of(y, near_z) : row_of(near_y, z)];
  const std::uint64_t* in_z = &half_seen_[z == 0 ? row_of(near_y, z) : row_of(y, near_z)];
  const std::uint64_t* in_both = &half_seen_[row_of(near_y, near_z)];
  const auto is_in_sight = [&](int x) { return line_is_clear(start, start + glm::ivec3(side * x, y, z)); };
  const bool along_z = std::abs(z) >= std::abs(y);
  const int longest = std::max(std::abs(y), std::abs(z));

  // First handles the part of the row where the line of sight has y or z as its longest axis.
  const std::uint64_t *ahead = along_z ? in_z : in_y, *aside = in_both;
  std::uint64_t any = 0;
  for (int w = 0; w < half_words_; ++w) {
    const auto towards = [&](const std::uint64_t* row) {
      return row[w] << 1 | (w > 0 ? row[w - 1] >> 63 : row[0] & 1);
    };
    const std::uint64_t a = ahead[w], b = aside[w], c = towards(ahead), d = towards(aside),
                        here = tissue[w] & up_to(longest, w);
    seen[w] = here & a & b & c & d;
    for (std::uint64_t doubtful = here & (a | b | c | d) & ~seen[w]; doubtful; doubtful &= doubtful - 1) {
      const int bit = std::countr_zero(doubtful);
      if (is_in_sight(w * 64 + bit)) seen[w] |= std::uint64_t{1} << bit;
    }
    // Then handles the remaining part of the row, where the line of sight has x as its longest axis.
    const std::uint64_t e = in_y[w], f = in_z[w], before_e = w > 0 ? in_y[w - 1] : 0,
                        before_f = w > 0 ? in_z[w - 1] : 0, before_b = w > 0 ? aside[w - 1] : 0,
                        beyond = tissue[w] & ~up_to(longest, w);
    certain_[w] = beyond & ((e & f & b) << 1 | (before_e & before_f & before_b) >> 63);
    possible_[w] = beyond & ((e | f | b) << 1 | (before_e | before_f | before_b) >> 63);
    any |= possible_[w] | (beyond & seen[w] << 1);
  }

  const int end = half_words_ * 64;
  const auto is_seen = [&](int x) { return (seen[x >> 6] >> (x & 63) & 1) != 0; };
  if (!any && (longest + 1 >= end || !is_seen(longest))) return;
  for (int x = longest + 1; x < end;) {
    if (is_seen(x - 1)) {
      const int stop = next_clear(certain_.data(), half_words_, x);
      set_range(seen, x, stop);
      x = stop;
      if (x >= end) return;
      if (!(tissue[x >> 6] >> (x & 63) & 1)) {
        ++x;
        continue;
      }
    } else {
      x = next_set(possible_.data(), half_words_, x);
      if (x >= end) return;
    }
    if (is_in_sight(x)) seen[x >> 6] |= std::uint64_t{1} << (x & 63);
    ++x;
  }
}

// Returns true if the straight line between the centres of two voxels stays in tissue. Walks the line through the faces
// of voxels. Where it passes exactly through a voxel edge, tissue on one side of the edge suffices.
bool BrushReach::line_is_clear(const glm::ivec3& from, const glm::ivec3& to) const {
  if (seams_) return line_crosses_no_seam(from, to);
  const int x = std::abs(to.x - from.x), y = std::abs(to.y - from.y), z = std::abs(to.z - from.z),
            step_x = to.x > from.x ? 1 : -1;
  const std::ptrdiff_t step_y = to.y > from.y ? words_ : -words_,
                       step_z = std::ptrdiff_t{to.z > from.z ? size_.y : -size_.y} * words_;
  const std::uint64_t* row = &tissue_rows_[(std::size_t(from.z) * size_.y + from.y) * words_];
  const auto is_tissue = [](const std::uint64_t* r, int at) { return (r[at >> 6] >> (at & 63) & 1) != 0; };
  // Along an axis with n voxel steps, the line crosses its k-th face at the fraction (k + 1/2) / n of its length. The
  // fractions are multiplied by 2 x y z, so that they are whole numbers.
  constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  const std::int64_t of_x = std::int64_t{std::max(y, 1)} * std::max(z, 1),
                     of_y = std::int64_t{std::max(x, 1)} * std::max(z, 1),
                     of_z = std::int64_t{std::max(x, 1)} * std::max(y, 1);
  std::int64_t next_x = x > 0 ? of_x : kNever, next_y = y > 0 ? of_y : kNever, next_z = z > 0 ? of_z : kNever;
  int at = from.x + low_.x - x0_;
  for (int steps = x + y + z; steps > 0; --steps) {
    const std::int64_t next = std::min({next_x, next_y, next_z});
    if (next_x == next && is_tissue(row, at + step_x)) {
      at += step_x;
      next_x += 2 * of_x;
    } else if (next_y == next && is_tissue(row + step_y, at)) {
      row += step_y;
      next_y += 2 * of_y;
    } else if (next_z == next && is_tissue(row + step_z, at)) {
      row += step_z;
      next_z += 2 * of_z;
    } else {
      return false;
    }
  }
  return true;
}

// Returns true if the line stays in tissue and crosses no seam. line_is_clear() calls this when a seam is near.
bool BrushReach::line_crosses_no_seam(const glm::ivec3& from, const glm::ivec3& to) const {
  const glm::ivec3 way = glm::abs(to - from), sign = glm::sign(to - from);
  constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  std::array<std::int64_t, 3> every, next;
  for (int axis = 0; axis < 3; ++axis) {
    every[axis] = std::int64_t{std::max(way[(axis + 1) % 3], 1)} * std::max(way[(axis + 2) % 3], 1);
    next[axis] = way[axis] > 0 ? every[axis] : kNever;
  }
  glm::ivec3 cell = from;
  for (int steps = way.x + way.y + way.z; steps > 0; --steps) {
    const std::int64_t first = std::min({next[0], next[1], next[2]});
    int axis = 0;
    while (axis < 3 && (next[axis] != first || !is_joined(cell, axis, sign[axis]))) ++axis;
    if (axis == 3) return false;
    cell[axis] += sign[axis];
    next[axis] += 2 * every[axis];
  }
  return true;
}

// Returns true if the neighbour of a window voxel along an axis (step 1 or -1) is tissue in the window and no seam lies
// between the two voxels.
bool BrushReach::is_joined(const glm::ivec3& cell, int axis, int step) const {
  glm::ivec3 next = cell;
  next[axis] += step;
  return is_set(tissue_rows_, next) && !(seams_ && seams_->is_cut_towards(low_ + cell, 2 * axis + (step > 0)));
}

// ---- The voxels out of sight: shortest paths lead to them around corners of the tissue.

bool BrushReach::is_set(const std::vector<std::uint64_t>& rows, const glm::ivec3& cell) const {
  if (cell.x < 0 || cell.y < 0 || cell.z < 0 || cell.x >= size_.x || cell.y >= size_.y || cell.z >= size_.z)
    return false;
  const int bit = cell.x + low_.x - x0_;
  return (rows[(std::size_t(cell.z) * size_.y + cell.y) * words_ + (bit >> 6)] >> (bit & 63) & 1) != 0;
}

std::int32_t BrushReach::rank_of(const glm::ivec3& cell) const {
  const int bit = cell.x + low_.x - x0_;
  const std::size_t word = (std::size_t(cell.z) * size_.y + cell.y) * words_ + (bit >> 6);
  return far_rank_[word] + bit_count(far_rows_[word] & ((std::uint64_t{1} << (bit & 63)) - 1));
}

float BrushReach::from_centre(const glm::ivec3& cell) const {
  return std::sqrt(squared_[0][cell.x + kBrick] + squared_[1][cell.y + kBrick] + squared_[2][cell.z + kBrick]);
}

float BrushReach::between(const glm::ivec3& a, const glm::ivec3& b) const {
  const glm::vec3 way = glm::vec3(a - b) * glm::vec3(volume_.grid.spacing);
  return std::sqrt(glm::dot(way, way));
}

// Starts a path to a voxel out of sight that touches voxels in sight, by face, edge or corner. The path bends at one of
// these seen voxels: the one over which the path is shortest.
void BrushReach::start_behind(const glm::ivec3& cell) {
  for (int n = 0; n < 27; ++n) {
    const glm::ivec3 step(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1), corner = cell + step;
    if (!is_set(seen_rows_, corner) || !is_open(cell, step)) continue;
    const float before = from_centre(corner);
    offer(cell, before + between(corner, cell), before, corner);
  }
}

// Returns true if paths through voxel faces, inside tissue, lead from `cell` to its neighbour at `step` (one of 26).
bool BrushReach::is_open(const glm::ivec3& cell, const glm::ivec3& step) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (step[axis] == 0) continue;
    glm::ivec3 next = cell, left = step;
    next[axis] += step[axis];
    left[axis] = 0;
    if (!(seams_ && seams_->is_cut_towards(low_ + cell, 2 * axis + (step[axis] > 0))) &&
        (left == glm::ivec3(0) || (is_set(tissue_rows_, next) && is_open(next, left))))
      return true;
  }
  return false;
}

// Finds the tissue in the ball that is out of sight, and starts paths where this tissue touches voxels in sight.
// Returns true if any path was started.
bool BrushReach::find_far() {
  const std::size_t words = tissue_rows_.size();
  far_rows_.resize(words);
  far_rank_.resize(words);
  std::int32_t count = 0;
  for (int z = 0, r = 0; z < size_.z; ++z)
    for (int y = 0; y < size_.y; ++y, ++r) {
      const Span ball = ball_[r];
      for (int w = 0; w < words_; ++w) {
        const std::size_t at = std::size_t(r) * words_ + w;
        std::uint64_t far = tissue_rows_[at] & ~seen_rows_[at];
        if (far) far &= ball.last < ball.first ? 0 : up_to(ball.last - x0_, w) & ~up_to(ball.first - 1 - x0_, w);
        far_rows_[at] = far;
        far_rank_[at] = count;
        count += bit_count(far);
      }
    }
  if (count == 0) return false;
  const auto seen = [&](int y, int z, int w) -> std::uint64_t {
    if (y < 0 || y >= size_.y || z < 0 || z >= size_.z || w < 0 || w >= words_) return 0;
    return seen_rows_[(std::size_t(z) * size_.y + y) * words_ + w];
  };
  bool found = false;
  for (int z = 0, r = 0; z < size_.z; ++z)
    for (int y = 0; y < size_.y; ++y, ++r)
      for (int w = 0; w < words_; ++w) {
        const std::uint64_t far = far_rows_[std::size_t(r) * words_ + w];
        if (!far) continue;
        const std::uint64_t own = seen(y, z, w), beside = own << 1 | seen(y, z, w - 1) >> 63 | own >> 1 |
                                                          seen(y, z, w + 1) << 63 | seen(y - 1, z, w) |
                                                          seen(y + 1, z, w) | seen(y, z - 1, w) | seen(y, z + 1, w);
        for (std::uint64_t first = far & beside; first; first &= first - 1) {
          if (!found) {
            far_distance_.assign(count, kFar);
            far_corner_.resize(count);
            per_bucket_ = static_cast<float>(
                2 / std::min({volume_.grid.spacing.x, volume_.grid.spacing.y, volume_.grid.spacing.z}));
            const std::size_t buckets = static_cast<std::size_t>(radius_ * per_bucket_) + 2;
            if (bucket_.size() < buckets) bucket_.resize(buckets);
            this_bucket_ = 0;
            found = true;
          }
          start_behind({w * 64 + std::countr_zero(first) + x0_ - low_.x, y, z});
        }
      }
  if (!found) std::fill(far_rows_.begin(), far_rows_.end(), 0);
  return found;
}

void BrushReach::offer(const glm::ivec3& cell, float distance, float before, const glm::ivec3& corner) {
  if (distance > radius_) return;
  const std::int32_t rank = rank_of(cell);
  // Ignores a path that is shorter than the known path only because of rounding.
  if (distance + 1e-5f * distance >= far_distance_[rank]) return;
  far_distance_[rank] = distance;
  far_corner_[rank] = {before, glm::i16vec3(corner)};
  // The path to this voxel can be shorter than the path to the voxel from which it is reached, since its last bend may
  // be nearer to it. Such a voxel is added to the bucket that is being processed, since earlier buckets are not
  // processed again.
  bucket_[std::max(static_cast<std::size_t>(distance * per_bucket_), this_bucket_)].push_back(
      {distance, rank, glm::i16vec3(cell)});
}

void BrushReach::spread_behind_corners() {
  for (this_bucket_ = 0; this_bucket_ < bucket_.size(); ++this_bucket_) {
    auto& front = bucket_[this_bucket_];
    for (std::size_t i = 0; i < front.size(); ++i) {
      const auto [here, rank, at] = front[i];
      if (far_distance_[rank] < here) continue;  // a shorter path to this voxel was found after this entry
      const glm::ivec3 cell(at);
      const auto [to_corner, from] = far_corner_[rank];
      for (int direction = 0; direction < 6; ++direction) {
        glm::ivec3 next = cell;
        next[direction >> 1] += direction & 1 ? 1 : -1;
        if (!is_set(far_rows_, next) || (seams_ && seams_->is_cut_towards(low_ + cell, direction))) continue;
        glm::ivec3 corner(from);
        float before = to_corner;
        const float known = far_distance_[rank_of(next)];
        if (before + between(corner, next) >= known) continue;
        if (!line_is_clear(corner, next)) {
          before = here;
          corner = cell;
        }
        offer(next, before + between(corner, next), before, corner);
      }
    }
    front.clear();
  }
}

// ---- The list of voxels that the dab touches

// Appends a brick's touched voxels to the result, with squared distances. dab() takes the square roots later.
void BrushReach::emit(int index, const Mask& touched, const Mask* far) {
  const TissueVoxels::Brick& brick = tissue_.bricks()[index];
  const glm::ivec3 from = brick.corner - low_ + kBrick;
  const float *x_squared = &squared_[0][from.x], *y_squared = &squared_[1][from.y], *z_squared = &squared_[2][from.z];
  std::uint16_t *at = reached_.at.data(), *cell = reached_.cell.data();
  float* distance = reached_.distance.data();
  std::int32_t count = reached_.bricks.empty() ? 0 : reached_.bricks.back().end;
  const std::int32_t begin = count;
  int place = 0;
  const float most = static_cast<float>(radius_);
  for (int z = 0; z < kBrick; ++z) {
    const std::uint64_t all = brick.mask[z], word = touched[z];
    if (!word) {
      place += bit_count(all);
      continue;
    }
    if (word == ~std::uint64_t{0} && !(far && (*far)[z])) {
      for (int i = 0; i < kBrick * kBrick; ++i) {
        at[count + i] = static_cast<std::uint16_t>(place + i);
        cell[count + i] = static_cast<std::uint16_t>(64 * z + i);
      }
      for (int y = 0; y < kBrick; ++y)
        for (int x = 0; x < kBrick; ++x)
          distance[count + kBrick * y + x] = x_squared[x] + (y_squared[y] + z_squared[z]);
      count += kBrick * kBrick;
      place += kBrick * kBrick;
      continue;
    }
    for (int y = 0; y < kBrick; ++y) {
      const unsigned row = all >> (8 * y) & 0xff, wanted = word >> (8 * y) & 0xff;
      if (!wanted) {
        if (row) place += bit_count(row);
        continue;
      }
      const float row_squared = y_squared[y] + z_squared[z];
      const unsigned behind = far ? (*far)[z] >> (8 * y) & 0xff : 0;
      if (wanted == 0xff && !behind) {
        for (int x = 0; x < kBrick; ++x) {
          at[count + x] = static_cast<std::uint16_t>(place + x);
          cell[count + x] = static_cast<std::uint16_t>(x + 8 * y + 64 * z);
          distance[count + x] = x_squared[x] + row_squared;
        }
        count += kBrick;
        place += kBrick;
        continue;
      }
      for (int x = 0; x < kBrick; ++x) {
        at[count] = static_cast<std::uint16_t>(place);
        cell[count] = static_cast<std::uint16_t>(x + 8 * y + 64 * z);
        distance[count] = x_squared[x] + row_squared;
        int counts = wanted >> x & 1;
        if (behind >> x & 1 & counts) {
          const float way = far_distance_[rank_of(brick.corner + glm::ivec3(x, y, z) - low_)];
          distance[count] = way * way;
          counts = way <= most;
        }
        count += counts;
        place += row >> x & 1;
      }
    }
  }
  if (count > begin) reached_.bricks.push_back({index, begin, count});
}

void BrushReach::emit_euclidean() {
  for (const int index : bricks_) {
    const TissueVoxels::Brick& brick = tissue_.bricks()[index];
    Mask touched;
    std::uint64_t any = 0;
    for (int z = 0; z < kBrick; ++z) any |= touched[z] = brick.mask[z] & ball_word(ball_, brick.corner, z);
    if (filtered_ && any)
      for (int z = 0; z < kBrick; ++z) touched[z] &= allowed_[allowed_of_[index]][z];
    if (any) emit(index, touched, nullptr);
  }
}

void BrushReach::emit_geodesic() {
  const bool corners = find_far();
  if (corners) spread_behind_corners();
  for (const int index : bricks_) {
    const TissueVoxels::Brick& brick = tissue_.bricks()[index];
    Mask touched, far{};
    std::uint64_t any = 0, any_far = 0;
    for (int z = 0; z < kBrick; ++z) {
      touched[z] = window_word(seen_rows_, brick.corner, z) & ball_word(ball_, brick.corner, z);
      if (corners) any_far |= far[z] = window_word(far_rows_, brick.corner, z);
      any |= touched[z] |= far[z];
    }
    if (filtered_ && any)
      for (int z = 0; z < kBrick; ++z) touched[z] &= allowed_[allowed_of_[index]][z];
    if (any) emit(index, touched, any_far ? &far : nullptr);
  }
}

const Reached& BrushReach::dab(const glm::dvec3& centre, double radius, BrushDistance distance) {
  reached_.bricks.clear();
  const auto resize = [&](std::int64_t size) {
    reached_.at.resize(size);
    reached_.cell.resize(size);
    reached_.distance.resize(size);
  };
  centre_ = voxel_from_world_ * centre;
  radius_ = radius;
  const bool geodesic = distance == BrushDistance::Geodesic;
  if (!(radius > 0) || (geodesic && !find_start()) || !place_window(radius, geodesic)) {
    resize(0);
    return reached_;
  }
  if (filtered_) need_allowed();

  place_ball(radius, ball_);
  std::int64_t most = kBrick;  // spare entries, because emit() always writes a whole row of eight voxels
  for (const Span& row : ball_) most += std::max(row.last - row.first + 1, 0);
  resize(most);  // not cleared, because all values are overwritten
  if (geodesic) {
    const glm::dvec3 spacing = volume_.grid.spacing;
    place_ball(
        radius + std::max({spacing.x, spacing.y, spacing.z}) + glm::length((glm::dvec3(start_) - centre_) * spacing),
        grown_ball_);
    gather_tissue();
    seen_rows_.assign(tissue_rows_.size(), 0);
    seams_ = seams_near();
    if (seams_) {
      see_start();
    } else {
      see(1);
      see(-1);
    }
    emit_geodesic();
  } else {
    emit_euclidean();
  }
  const std::int32_t count = reached_.bricks.empty() ? 0 : reached_.bricks.back().end;
  for (std::int32_t i = 0; i < count; ++i) reached_.distance[i] = std::sqrt(reached_.distance[i]);
  resize(count);
  return reached_;
}

std::int64_t BrushReach::memory_bytes() const {
  const auto bytes = [](const auto& list) { return static_cast<std::int64_t>(list.capacity() * sizeof(list[0])); };
  std::int64_t all = bytes(ball_) + bytes(grown_ball_) + bytes(bricks_) + bytes(tissue_rows_) + bytes(seen_rows_) +
                     bytes(far_rows_) + bytes(half_tissue_) + bytes(half_seen_) + bytes(far_rank_) +
                     bytes(far_distance_) + bytes(far_corner_) + bytes(allowed_of_) + bytes(allowed_) +
                     bytes(reached_.bricks) + bytes(reached_.at) + bytes(reached_.cell) + bytes(reached_.distance);
  for (const auto& list : bucket_) all += bytes(list);
  return all;
}

}  // namespace limber
