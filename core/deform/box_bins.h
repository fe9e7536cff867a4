// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds which of many boxes intersect a given box, or which of many points lie near a point. Boxes are ranges of whole
// voxels; they are sorted into cubic bins.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/deform/lattice.h"

namespace limber {

class BoxBins {
 public:
  BoxBins() = default;
  //   boxes  boxes to search; empty boxes are never found
  //   bin    edge of a bin, voxels
  BoxBins(std::vector<VoxelRange> boxes, int bin) : boxes_(std::move(boxes)), bin_(bin) {
    VoxelRange all;
    for (const VoxelRange& box : boxes_)
      if (!box.empty()) all = all.empty() ? box : VoxelRange{glm::min(all.low, box.low), glm::max(all.high, box.high)};
    if (all.empty()) return;
    first_ = bin_of(all.low);
    size_ = bin_of(all.high) - first_ + 1;
    begin_.assign(std::size_t(size_.x) * size_.y * size_.z + 1, 0);
    for_each_entry([&](std::int64_t bin_at, int) { ++begin_[bin_at + 1]; });
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    entries_.resize(begin_.back());
    std::vector<std::int64_t> end(begin_.begin(), begin_.end() - 1);
    for_each_entry([&](std::int64_t bin_at, int box) { entries_[end[bin_at]++] = box; });
  }

  // Writes the indices of the boxes that intersect `range`, in ascending order, into `found`.
  template <class Index>
  void meeting(const VoxelRange& range, std::vector<Index>& found) const {
    found.clear();
    if (begin_.empty() || range.empty()) return;
    const glm::ivec3 low = glm::max(bin_of(range.low) - first_, glm::ivec3(0)),
                     high = glm::min(bin_of(range.high) - first_, size_ - 1);
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
          const std::int64_t at = x + std::int64_t{size_.x} * (y + std::int64_t{size_.y} * z);
          for (std::int64_t e = begin_[at]; e < begin_[at + 1]; ++e)
            if (!intersect(boxes_[entries_[e]], range).empty()) found.push_back(entries_[e]);
        }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
  }

 private:
  glm::ivec3 bin_of(const glm::ivec3& voxel) const { return glm::ivec3(glm::floor(glm::dvec3(voxel) / double(bin_))); }

  template <class Body>
  void for_each_entry(const Body& body) const {
    for (int b = 0; b < static_cast<int>(boxes_.size()); ++b) {
      if (boxes_[b].empty()) continue;
      const glm::ivec3 low = bin_of(boxes_[b].low) - first_, high = bin_of(boxes_[b].high) - first_;
      for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
          for (int x = low.x; x <= high.x; ++x) body(x + std::int64_t{size_.x} * (y + std::int64_t{size_.y} * z), b);
    }
  }

  std::vector<VoxelRange> boxes_;
  int bin_ = 1;
  glm::ivec3 first_{0}, size_{0};
  std::vector<std::int64_t> begin_;
  std::vector<int> entries_;
};

// Finds points near a place. The bins are as wide as the search, so its cost is the same in every unit of length.
class PointBins {
 public:
  PointBins(const std::vector<glm::dvec3>& points, double reach) {
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const glm::dvec3& p : points) low = glm::min(low, p), high = glm::max(high, p);
    const glm::dvec3 size = points.empty() ? glm::dvec3(0) : high - low;
    reach_ = std::max({reach, kLeastReach * std::max({size.x, size.y, size.z}), 1e-30});
    std::vector<VoxelRange> boxes;
    for (const glm::dvec3& p : points) boxes.push_back({cell_of(p), cell_of(p)});
    bins_ = BoxBins(std::move(boxes), kCells);
  }

  // Writes the indices of the points within `reach` of a place, and of some points further away, in ascending order,
  // into `found`.
  void near(const glm::dvec3& place, std::vector<int>& found) const {
    const glm::ivec3 cell = cell_of(place);
    bins_.meeting({cell - (kCells + 1), cell + (kCells + 1)}, found);
  }

 private:
  static constexpr int kCells = 8;             // cells along the reach; a bin is as wide
  static constexpr double kLeastReach = 0.01;  // least width of a bin, as a share of the points' extent
  glm::ivec3 cell_of(const glm::dvec3& p) const { return glm::ivec3(glm::floor(p * (kCells / reach_))); }

  BoxBins bins_;
  double reach_ = 1;
};

}  // namespace limber
