// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/surface_points.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/parallel.h"

namespace limber {

namespace {
constexpr int kLeaf = 8;
constexpr double kSameSide = 0.5;  // cosine of the largest angle between matching normals
const glm::ivec3 kFaces[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
}  // namespace

Occupancy occupancy_of(const LabelVolume& volume, const LabelSet& labels, double spacing) {
  const Grid& fine = volume.grid;
  const glm::ivec3 factor = glm::max(glm::ivec3(1), glm::ivec3(glm::round(spacing / fine.spacing)));
  Occupancy result;
  Grid& grid = result.grid;
  grid.size = (fine.size + factor - 1) / factor;
  grid.spacing = fine.spacing * glm::dvec3(factor);
  grid.direction = fine.direction;
  grid.origin = world_from_voxel(fine) * (0.5 * glm::dvec3(factor - 1));
  result.share.assign(grid.voxel_count(), 0);
  parallel_for(grid.size.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (int cz = static_cast<int>(begin); cz < end; ++cz) {
      float* layer = &result.share[grid.index({0, 0, cz})];
      const int last = std::min((cz + 1) * factor.z, fine.size.z);
      for (int z = cz * factor.z; z < last; ++z)
        for (int y = 0; y < fine.size.y; ++y) {
          const Label* row = &volume.voxels[fine.index({0, y, z})];
          float* cells = layer + std::int64_t{grid.size.x} * (y / factor.y);
          for (int x = 0; x < fine.size.x; ++x) cells[x / factor.x] += labels[row[x]] != 0;
        }
      // Cells at the far border hold fewer voxels.
      for (int y = 0; y < grid.size.y; ++y)
        for (int x = 0; x < grid.size.x; ++x) {
          const glm::ivec3 held = glm::min(factor, fine.size - glm::ivec3(x, y, cz) * factor);
          layer[x + std::int64_t{grid.size.x} * y] /= static_cast<float>(held.x * held.y * held.z);
        }
    }
  });
  return result;
}

void close_body(Occupancy& body) {
  const Grid& grid = body.grid;
  const std::int64_t count = grid.voxel_count();
  // Pieces of filled cells, and the air that the border reaches.
  std::vector<std::int32_t> piece(count, 0);  // 0 unseen, -1 open air, else the number of its piece
  std::vector<std::int64_t> pieces{0};
  std::vector<glm::ivec3> front;
  const auto flood = [&](const glm::ivec3& seed, bool filled, std::int32_t mark) {
    std::int64_t cells = 0;
    piece[grid.index(seed)] = mark;
    front.assign(1, seed);
    while (!front.empty()) {
      const glm::ivec3 at = front.back();
      front.pop_back();
      ++cells;
      for (const glm::ivec3& face : kFaces) {
        const glm::ivec3 next = at + face;
        if (!grid.contains(next) || piece[grid.index(next)] != 0 || body.filled(next) != filled) continue;
        piece[grid.index(next)] = mark;
        front.push_back(next);
      }
    }
    return cells;
  };
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x) {
        const glm::ivec3 at(x, y, z);
        if (piece[grid.index(at)] != 0) continue;
        const bool border = x == 0 || y == 0 || z == 0 || x + 1 == grid.size.x || y + 1 == grid.size.y || z + 1 == grid.size.z;
        if (body.filled(at)) pieces.push_back(flood(at, true, static_cast<std::int32_t>(pieces.size())));
        else if (border) flood(at, false, -1);
      }
  const auto largest = static_cast<std::int32_t>(std::max_element(pieces.begin(), pieces.end()) - pieces.begin());
  for (std::int64_t i = 0; i < count; ++i) {
    if (piece[i] == 0) body.share[i] = 1;
    if (piece[i] > 0 && piece[i] != largest && 50 * pieces[piece[i]] < pieces[largest]) body.share[i] = 0;
  }
}

std::vector<SurfacePoint> surface_points(const Occupancy& occupancy) {
  const Grid& grid = occupancy.grid;
  const glm::ivec3 size = grid.size;
  const auto share = [&](glm::ivec3 cell) {
    cell = glm::clamp(cell, glm::ivec3(0), size - 1);  // beyond the border goes on what lies at it
    return occupancy.share[grid.index(cell)];
  };
  const AffineTransform to_world = world_from_voxel(grid);
  const glm::dmat3 across = grid.direction * glm::dmat3(1 / grid.spacing.x, 0, 0, 0, 1 / grid.spacing.y, 0, 0, 0, 1 / grid.spacing.z);
  std::vector<std::vector<SurfacePoint>> layers(size.z);
  parallel_for(size.z, 1, [&](std::int64_t begin, std::int64_t end) {
    for (int z = static_cast<int>(begin); z < end; ++z)
      for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
          const glm::ivec3 cell(x, y, z);
          const float here = share(cell);
          if (here < 0.5f) continue;
          glm::dvec3 normal(0);
          bool has_normal = false;
          for (const glm::ivec3& face : kFaces) {
            const glm::ivec3 next = cell + face;
            if (!grid.contains(next)) continue;
            const float there = share(next);
            if (there >= 0.5f) continue;
            if (!has_normal) {
              // The gradient of the share under a 5^3 tent.
              for (int k = -2; k <= 2; ++k)
                for (int j = -2; j <= 2; ++j)
                  for (int i = -2; i <= 2; ++i) {
                    const double near = (3 - std::abs(i)) * (3 - std::abs(j)) * (3 - std::abs(k));
                    normal -= near * share(cell + glm::ivec3(i, j, k)) * glm::dvec3(i, j, k);
                  }
              normal = across * normal;
              has_normal = true;
            }
            glm::dvec3 out = normal;
            if (!(glm::length(out) > 1e-9)) out = grid.direction * glm::dvec3(face);
            const double t = (here - 0.5) / (here - there);
            layers[z].push_back({to_world * (glm::dvec3(cell) + t * glm::dvec3(face)), glm::normalize(out)});
          }
        }
  });
  std::vector<SurfacePoint> points;
  for (const auto& layer : layers) points.insert(points.end(), layer.begin(), layer.end());
  return points;
}

std::vector<SurfacePoint> thinned(const std::vector<SurfacePoint>& points, double step) {
  std::vector<std::tuple<double, double, double, int>> cubes;
  cubes.reserve(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 cube = glm::floor(points[i].place / step);
    cubes.push_back({cube.z, cube.y, cube.x, static_cast<int>(i)});
  }
  std::sort(cubes.begin(), cubes.end());
  std::vector<SurfacePoint> result;
  for (size_t i = 0; i < cubes.size(); ++i)
    if (i == 0 || std::tie(std::get<0>(cubes[i]), std::get<1>(cubes[i]), std::get<2>(cubes[i])) !=
                      std::tie(std::get<0>(cubes[i - 1]), std::get<1>(cubes[i - 1]), std::get<2>(cubes[i - 1])))
      result.push_back(points[std::get<3>(cubes[i])]);
  return result;
}

PointTree::PointTree(const std::vector<SurfacePoint>& points) : points_(points), order_(points.size()), axis_(points.size(), 0) {
  for (size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<std::int32_t>(i);
  build(0, static_cast<int>(order_.size()));
}

void PointTree::build(int begin, int end) {
  if (end - begin <= kLeaf) return;
  glm::dvec3 low(1e300), high(-1e300);
  for (int i = begin; i < end; ++i) low = glm::min(low, points_[order_[i]].place), high = glm::max(high, points_[order_[i]].place);
  const glm::dvec3 extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const int middle = (begin + end) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](std::int32_t a, std::int32_t b) {
    const double u = points_[a].place[axis], v = points_[b].place[axis];
    return u < v || (u == v && a < b);
  });
  axis_[middle] = static_cast<std::uint8_t>(axis);
  build(begin, middle);
  build(middle + 1, end);
}

int PointTree::nearest(const glm::dvec3& place, const glm::dvec3& normal, double reach) const {
  double squared = reach * reach;
  int best = -1;
  search(0, static_cast<int>(order_.size()), place, normal, squared, best);
  return best;
}

void PointTree::search(int begin, int end, const glm::dvec3& place, const glm::dvec3& normal, double& squared, int& best) const {
  const auto look = [&](int number) {
    const SurfacePoint& point = points_[number];
    const glm::dvec3 to = point.place - place;
    const double d = glm::dot(to, to);
    if (d > squared || (d == squared && (best < 0 || number > best))) return;
    if (normal != glm::dvec3(0) && glm::dot(point.normal, normal) < kSameSide) return;
    squared = d;
    best = number;
  };
  if (end - begin <= kLeaf) {
    for (int i = begin; i < end; ++i) look(order_[i]);
    return;
  }
  const int middle = (begin + end) / 2, axis = axis_[middle];
  const double side = place[axis] - points_[order_[middle]].place[axis];
  const auto visit = [&](bool low) { low ? search(begin, middle, place, normal, squared, best) : search(middle + 1, end, place, normal, squared, best); };
  visit(side <= 0);
  look(order_[middle]);
  if (side * side <= squared) visit(side > 0);
}

}  // namespace limber
