// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/limb_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

#include "core/volume/distance_transform.h"

namespace limber {

namespace {

constexpr float kUnseen = std::numeric_limits<float>::max();
constexpr double kStep = 8;  // distance between points of a path, mm
// An end of the body gets no path if its prominence is below this share of the longest path's length. The prominence is
// the distance from the end back to the point where the path to a farther end branches off.
constexpr double kLeastShare = 0.12;
constexpr size_t kMostEnds = 12;

class Body {
 public:
  explicit Body(const Occupancy& body) : grid_(body.grid), to_world_(world_from_voxel(body.grid)) {
    number_.assign(grid_.voxel_count(), -1);
    for (int z = 0; z < grid_.size.z; ++z)
      for (int y = 0; y < grid_.size.y; ++y)
        for (int x = 0; x < grid_.size.x; ++x)
          if (body.filled({x, y, z})) {
            number_[grid_.index({x, y, z})] = static_cast<std::int32_t>(cell_.size());
            cell_.push_back({x, y, z});
          }
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
          if (x || y || z)
            offset_.push_back({x, y, z}),
                stride_.push_back(static_cast<float>(glm::length(glm::dvec3(x, y, z) * grid_.spacing)));
  }

  std::int64_t size() const { return std::ssize(cell_); }
  glm::dvec3 world(std::int32_t i) const { return to_world_ * glm::dvec3(cell_[i]); }

  std::int32_t thickest() const {
    VoxelBox box{glm::ivec3(0), grid_.size};
    std::vector<std::uint8_t> air(grid_.voxel_count());
    for (std::int64_t i = 0; i < grid_.voxel_count(); ++i) air[i] = number_[i] < 0;
    const std::vector<float> depth = squared_distance(box, air, grid_.spacing);
    std::int32_t best = 0;
    for (std::int32_t i = 0; i < size(); ++i)
      if (depth[grid_.index(cell_[i])] > depth[grid_.index(cell_[best])]) best = i;
    return best;
  }

  // Computes for each cell the length of the shortest path through the tissue from the cell `from`, and the previous
  // cell on this path.
  void measure(std::int32_t from) {
    distance_.assign(cell_.size(), kUnseen);
    before_.assign(cell_.size(), -1);
    using Entry = std::pair<float, std::int32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
    distance_[from] = 0;
    front.push({0, from});
    while (!front.empty()) {
      const auto [d, i] = front.top();
      front.pop();
      if (d > distance_[i]) continue;
      each_neighbour(i, [&](std::int32_t n, float stride) {
        if (d + stride >= distance_[n]) return;
        distance_[n] = d + stride;
        before_[n] = i;
        front.push({d + stride, n});
      });
    }
  }
  std::int32_t farthest() const {
    std::int32_t best = 0;
    for (std::int32_t i = 0; i < size(); ++i)
      if (distance_[i] != kUnseen && (distance_[best] == kUnseen || distance_[i] > distance_[best])) best = i;
    return best;
  }
  double distance(std::int32_t i) const { return distance_[i]; }

  // Returns the local maxima of the distance, each with its prominence: the distance from the maximum back to the point
  // where the path to a farther one branches off. Cells are visited in descending order of distance and joined to
  // regions, one for each maximum. When two regions meet, the prominence of the lower maximum is known, and its region
  // is merged into the region of the higher one.
  std::vector<std::pair<double, std::int32_t>> summits() const {
    std::vector<std::int32_t> order;
    for (std::int32_t i = 0; i < size(); ++i)
      if (distance_[i] != kUnseen) order.push_back(i);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return distance_[a] > distance_[b] || (distance_[a] == distance_[b] && a < b); });
    // Forest of a union-find structure; the root of a region is its maximum.
    std::vector<std::int32_t> parent(cell_.size(), -1);
    const auto root = [&](std::int32_t i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    std::vector<std::pair<double, std::int32_t>> found;
    for (std::int32_t i : order) {
      parent[i] = i;
      each_neighbour(i, [&](std::int32_t n, float) {
        if (parent[n] < 0) return;
        std::int32_t a = root(i), b = root(n);
        if (a == b) return;
        if (distance_[b] > distance_[a] || (distance_[b] == distance_[a] && b < a)) std::swap(a, b);
        if (distance_[b] > distance_[i]) found.push_back({distance_[b] - distance_[i], b});
        parent[b] = a;
      });
    }
    if (!order.empty()) found.push_back({distance_[order[0]], order[0]});
    std::sort(found.begin(), found.end(),
              [](auto& a, auto& b) { return a.first > b.first || (a.first == b.first && a.second < b.second); });
    return found;
  }

  // Returns the path from the cell `end` to the cell from which distances are measured. Every point is moved to the
  // middle of the limb: the mean of the cells with the same distance.
  LimbPath path(std::int32_t end, double reach) const {
    std::vector<glm::dvec3> way;
    std::vector<double> far;
    for (std::int32_t i = end; i >= 0; i = before_[i]) way.push_back(world(i)), far.push_back(distance_[i]);
    LimbPath path{.step = kStep, .length = far.front()};
    const double band = std::max(kStep, 2 * std::max({grid_.spacing.x, grid_.spacing.y, grid_.spacing.z}));
    const auto sorted = by_distance();
    size_t k = 0;
    for (double along = 0; along <= path.length; along += kStep) {
      const double level = path.length - along;
      while (k + 1 < way.size() && far[k + 1] >= level) ++k;
      glm::dvec3 sum(0);
      int count = 0;
      auto from = std::lower_bound(sorted.begin(), sorted.end(), level - band / 2,
                                   [&](std::int32_t i, double d) { return distance_[i] < d; });
      for (; from != sorted.end() && distance_[*from] <= level + band / 2; ++from)
        if (const glm::dvec3 p = world(*from); glm::distance(p, way[k]) < reach) sum += p, ++count;
      path.points.push_back(count ? sum / double(count) : way[k]);
    }
    return path;
  }

 private:
  template <class Visit>
  void each_neighbour(std::int32_t i, const Visit& visit) const {
    for (size_t k = 0; k < offset_.size(); ++k) {
      const glm::ivec3 next = cell_[i] + offset_[k];
      if (!grid_.contains(next)) continue;
      if (const std::int32_t n = number_[grid_.index(next)]; n >= 0) visit(n, stride_[k]);
    }
  }
  const std::vector<std::int32_t>& by_distance() const {
    if (sorted_.size() != cell_.size()) {
      sorted_.resize(cell_.size());
      std::iota(sorted_.begin(), sorted_.end(), 0);
      std::sort(sorted_.begin(), sorted_.end(),
                [&](int a, int b) { return distance_[a] < distance_[b] || (distance_[a] == distance_[b] && a < b); });
    }
    return sorted_;
  }

  Grid grid_;
  AffineTransform to_world_;
  std::vector<std::int32_t> number_;
  std::vector<glm::ivec3> cell_, offset_;
  std::vector<float> stride_, distance_;
  std::vector<std::int32_t> before_;
  mutable std::vector<std::int32_t> sorted_;
};

}  // namespace

glm::dvec3 LimbPath::at(double along) const {
  if (points.empty()) return glm::dvec3(0);
  const double t = std::clamp(along / step, 0.0, double(points.size() - 1));
  const size_t k = std::min<size_t>(static_cast<size_t>(t), points.size() - 1),
               next = std::min(k + 1, points.size() - 1);
  return glm::mix(points[k], points[next], t - double(k));
}

std::vector<LimbPath> limb_paths(const Occupancy& occupancy, PathCentre centre) {
  Body body(occupancy);
  std::vector<LimbPath> paths;
  if (body.size() == 0) return paths;
  std::int32_t start = body.thickest();
  body.measure(start);
  if (centre == PathCentre::FarthestEnd) body.measure(body.farthest());
  const double longest = body.distance(body.farthest());
  for (const auto& [prominence, summit] : body.summits()) {
    if (prominence < kLeastShare * longest || paths.size() >= kMostEnds) break;
    paths.push_back(body.path(summit, 0.08 * longest));
    paths.back().prominence = prominence;
  }
  return paths;
}

}  // namespace limber
