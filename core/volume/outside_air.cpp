// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume/outside_air.h"

#include <algorithm>
#include <utility>

#include "core/volume/label_runs.h"

namespace limber {

namespace {

// Returns the lowest and the highest corner voxel of the tissue's bounding box. Without tissue, the lowest is greater
// than the highest.
std::pair<glm::ivec3, glm::ivec3> box_of_tissue(const LabelVolume& volume) {
  glm::ivec3 lowest = volume.grid.size, highest(-1);
  const int size = volume.grid.size.x;
  for (int z = 0; z < volume.grid.size.z; ++z)
    for (int y = 0; y < volume.grid.size.y; ++y) {
      const Label* row = &volume.voxels[volume.grid.index({0, y, z})];
      const int first = end_of_air(row, 0, size);
      if (first == size) continue;
      int last = size - 1;
      while (row[last] == 0) --last;
      lowest = glm::min(lowest, glm::ivec3(first, y, z));
      highest = glm::max(highest, glm::ivec3(last, y, z));
    }
  return {lowest, highest};
}

// Marks outside air by flood filling, one stretch of a row along x at a time.
class AirFlood {
 public:
  explicit AirFlood(const LabelVolume& volume)
      : volume_(volume),
        size_(volume.grid.size),
        outside_(volume.voxels.size(), 0) {}

  // Marks all voxels beyond the tissue's bounding box as outside air, and spreads from them. These voxels are connected
  // to an edge of the volume, because each slab of air between the bounding box and a face of the volume contains the
  // four edges of this face.
  void start_around_tissue() {
    const auto [lowest, highest] = box_of_tissue(volume_);
    const auto is_beyond = [&](int y, int z) { return y < lowest.y || y > highest.y || z < lowest.z || z > highest.z; };
    found_any_ = lowest != glm::ivec3(0) || highest != size_ - 1;
    for (int z = 0; z < size_.z; ++z)
      for (int y = 0; y < size_.y; ++y) {
        const auto row = outside_.begin() + volume_.grid.index({0, y, z});
        if (is_beyond(y, z)) {
          std::fill(row, row + size_.x, std::uint8_t{1});
          continue;
        }
        std::fill(row, row + lowest.x, std::uint8_t{1});
        std::fill(row + highest.x + 1, row + size_.x, std::uint8_t{1});
      }
    // Spreads into the bounding box, through those of its faces that have air beyond them.
    for (int z = lowest.z; z <= highest.z; ++z)
      for (int y = lowest.y; y <= highest.y; ++y) {
        const bool is_side = (y == lowest.y && y > 0) || (y == highest.y && y + 1 < size_.y) ||
                             (z == lowest.z && z > 0) || (z == highest.z && z + 1 < size_.z);
        if (is_side) add_row(lowest.x, highest.x + 1, y, z);
        if (lowest.x > 0) add({lowest.x, y, z});
        if (highest.x + 1 < size_.x) add({highest.x, y, z});
      }
    spread();
  }

  // Spreads outside air from every air voxel that lies on at least `sides` faces of the volume. With 2, these are the
  // voxels on the volume's edges.
  void start(int sides) {
    for (int z = 0; z < size_.z; ++z)
      for (int y = 0; y < size_.y; ++y) {
        const int here = (y == 0 || y == size_.y - 1) + (z == 0 || z == size_.z - 1);
        if (here >= sides)
          for (int x = 0; x < size_.x; ++x) add({x, y, z});
        else if (here + 1 >= sides)
          for (const int x : {0, size_.x - 1}) add({x, y, z});
      }
    spread();
  }

  bool found_any() const { return found_any_; }
  std::vector<std::uint8_t> take() { return std::move(outside_); }

 private:
  bool is_new(std::int64_t index) const { return volume_.voxels[index] == 0 && !outside_[index]; }

  void add(const glm::ivec3& v) {
    if (is_new(volume_.grid.index(v))) waiting_.push_back(v);
  }

  void spread() {
    while (!waiting_.empty()) {
      const glm::ivec3 v = waiting_.back();
      waiting_.pop_back();
      if (!is_new(volume_.grid.index(v))) continue;
      found_any_ = true;
      int begin = v.x, end = v.x + 1;
      const std::int64_t row = volume_.grid.index({0, v.y, v.z});
      while (begin > 0 && is_new(row + begin - 1)) --begin;
      while (end < size_.x && is_new(row + end)) ++end;
      std::fill(outside_.begin() + row + begin, outside_.begin() + row + end, std::uint8_t{1});
      for (const auto& [y, z] :
           {std::pair(v.y - 1, v.z), std::pair(v.y + 1, v.z), std::pair(v.y, v.z - 1), std::pair(v.y, v.z + 1)})
        if (y >= 0 && z >= 0 && y < size_.y && z < size_.z) add_row(begin, end, y, z);
    }
  }

  // Queues one voxel of each stretch of unmarked air with begin <= x < end in row (y, z).
  void add_row(int begin, int end, int y, int z) {
    const std::int64_t row = volume_.grid.index({0, y, z});
    for (int x = begin; x < end; ++x)
      if (is_new(row + x) && (x == begin || !is_new(row + x - 1))) waiting_.push_back({x, y, z});
  }

  const LabelVolume& volume_;
  const glm::ivec3 size_;
  std::vector<std::uint8_t> outside_;
  std::vector<glm::ivec3> waiting_;
  bool found_any_ = false;
};

}  // namespace

std::vector<std::uint8_t> outside_air(const LabelVolume& volume) {
  AirFlood flood(volume);
  flood.start_around_tissue();
  flood.start(2);
  if (!flood.found_any()) flood.start(1);
  return flood.take();
}

}  // namespace limber
