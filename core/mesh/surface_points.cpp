// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/surface_points.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/parallel.h"

namespace limber {

namespace {
constexpr int kLeaf = 8;
constexpr double kSameSide = 0.5;  // two normals match if the cosine of their angle is at least this
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
      // Divides by the number of voxels in each cell; cells at the grid's far border contain fewer voxels.
      for (int y = 0; y < grid.size.y; ++y)
        for (int x = 0; x < grid.size.x; ++x) {
          const glm::ivec3 held = glm::min(factor, fine.size - glm::ivec3(x, y, cz) * factor);
          layer[x + std::int64_t{grid.size.x} * y] /= static_cast<float>(held.x * held.y * held.z);
        }
    }
  });
  return result;
}

namespace {

// A run of adjacent cells along x that are all filled or all empty. `piece` is the index of another run of the same
// connected component; following it repeatedly leads to the component's first run (union-find).
struct Run {
  int begin = 0, end = 0;
  bool filled = false;
  std::int32_t piece = 0;
};

std::int32_t piece_of(std::vector<Run>& runs, std::int32_t i) {
  while (runs[i].piece != i) i = runs[i].piece = runs[runs[i].piece].piece;
  return i;
}

}  // namespace

void close_body(Occupancy& body) {
  const glm::ivec3 size = body.grid.size;
  std::vector<Run> runs;
  std::vector<std::int32_t> first;  // index of the first run of each row
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y) {
      const float* row = &body.share[body.grid.index({0, y, z})];
      first.push_back(static_cast<std::int32_t>(runs.size()));
      for (int x = 0; x < size.x; ++x) {
        const bool filled = row[x] >= 0.5f;
        if (x == 0 || filled != runs.back().filled)
          runs.push_back({x, x, filled, static_cast<std::int32_t>(runs.size())});
        runs.back().end = x + 1;
      }
    }
  first.push_back(static_cast<std::int32_t>(runs.size()));
  const auto join = [&](std::int64_t row, std::int64_t other) {
    std::int32_t i = first[row], j = first[other];
    while (i < first[row + 1] && j < first[other + 1]) {
      if (runs[i].filled == runs[j].filled) {
        const std::int32_t a = piece_of(runs, i), b = piece_of(runs, j);
        runs[std::max(a, b)].piece = std::min(a, b);
      }
      const bool next = runs[i].end <= runs[j].end, also = runs[j].end <= runs[i].end;
      i += next, j += also;
    }
  };
  const std::int64_t rows = std::int64_t{size.y} * size.z;
  for (std::int64_t row = 0; row < rows; ++row) {
    if (row % size.y != 0) join(row, row - 1);
    if (row >= size.y) join(row, row - size.y);
  }

  std::vector<std::int64_t> cells(runs.size(), 0);
  std::vector<std::uint8_t> open(runs.size(), 0);  // 1 for each component that reaches the grid's border
  for (std::int64_t row = 0; row < rows; ++row) {
    const std::int64_t y = row % size.y, z = row / size.y;
    const bool edge = y == 0 || y + 1 == size.y || z == 0 || z + 1 == size.z;
    for (std::int32_t i = first[row]; i < first[row + 1]; ++i) {
      const std::int32_t piece = piece_of(runs, i);
      cells[piece] += runs[i].end - runs[i].begin;
      open[piece] |= edge || runs[i].begin == 0 || runs[i].end == size.x;
    }
  }
  std::int64_t largest = 0;
  for (size_t i = 0; i < runs.size(); ++i)
    if (runs[i].filled) largest = std::max(largest, cells[i]);
  for (std::int64_t row = 0; row < rows; ++row)
    for (std::int32_t i = first[row]; i < first[row + 1]; ++i) {
      const std::int32_t piece = piece_of(runs, i);
      const bool hole = !runs[i].filled && !open[piece], speck = runs[i].filled && 50 * cells[piece] < largest;
      float* cell = &body.share[row * size.x];
      if (hole || speck) std::fill(cell + runs[i].begin, cell + runs[i].end, hole ? 1.0f : 0.0f);
    }
}

Occupancy coarsened(const Occupancy& fine, double spacing) {
  const glm::ivec3 factor = glm::max(glm::ivec3(1), glm::ivec3(glm::round(spacing / fine.grid.spacing)));
  Occupancy coarse;
  coarse.grid = fine.grid;
  coarse.grid.size = (fine.grid.size + factor - 1) / factor;
  coarse.grid.spacing = fine.grid.spacing * glm::dvec3(factor);
  coarse.grid.origin = world_from_voxel(fine.grid) * (0.5 * glm::dvec3(factor - 1));
  coarse.share.assign(coarse.grid.voxel_count(), 0);
  const float each = 1.0f / static_cast<float>(factor.x * factor.y * factor.z);
  const glm::ivec3 size = fine.grid.size;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y) {
      const float* row = &fine.share[fine.grid.index({0, y, z})];
      float* cells = &coarse.share[coarse.grid.index({0, y / factor.y, z / factor.z})];
      for (int x = 0; x < size.x; ++x) cells[x / factor.x] += each * row[x];
    }
  return coarse;
}

std::vector<SurfacePoint> surface_points(const Occupancy& occupancy) {
  const Grid& grid = occupancy.grid;
  const glm::ivec3 size = grid.size;
  const auto share = [&](glm::ivec3 cell) {
    cell = glm::clamp(cell, glm::ivec3(0), size - 1);  // cells beyond the border repeat the outermost cells
    return occupancy.share[grid.index(cell)];
  };
  const AffineTransform to_world = world_from_voxel(grid);
  const glm::dmat3 across =
      grid.direction * glm::dmat3(1 / grid.spacing.x, 0, 0, 0, 1 / grid.spacing.y, 0, 0, 0, 1 / grid.spacing.z);
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
              // Computes the negative gradient of the share, smoothed by a tent filter of 5 x 5 x 5 cells.
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

PointTree::PointTree(const std::vector<SurfacePoint>& points) : nodes_(points.size()), axis_(points.size(), 0) {
  for (size_t i = 0; i < nodes_.size(); ++i) nodes_[i] = {points[i], static_cast<std::int32_t>(i)};
  build(0, static_cast<int>(nodes_.size()));
}

void PointTree::build(int begin, int end) {
  if (end - begin <= kLeaf) return;
  glm::dvec3 low(1e300), high(-1e300);
  for (int i = begin; i < end; ++i)
    low = glm::min(low, nodes_[i].point.place), high = glm::max(high, nodes_[i].point.place);
  const glm::dvec3 extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const int middle = (begin + end) / 2;
  std::nth_element(nodes_.begin() + begin, nodes_.begin() + middle, nodes_.begin() + end,
                   [&](const Node& a, const Node& b) {
                     const double u = a.point.place[axis], v = b.point.place[axis];
                     return u < v || (u == v && a.number < b.number);
                   });
  axis_[middle] = static_cast<std::uint8_t>(axis);
  build(begin, middle);
  build(middle + 1, end);
}

int PointTree::nearest(const glm::dvec3& place, const glm::dvec3& normal, double reach) const {
  Search search{place, normal, normal == glm::dvec3(0) ? -2 : kSameSide, reach * reach};
  look_in(0, static_cast<int>(nodes_.size()), search);
  return search.best;
}

void PointTree::look_in(int begin, int end, Search& search) const {
  const auto look = [&](const Node& node) {
    const glm::dvec3 to = node.point.place - search.place;
    const double d = glm::dot(to, to);
    if (d > search.squared || (d == search.squared && (search.best < 0 || node.number > search.best))) return;
    if (glm::dot(node.point.normal, search.normal) < search.least_facing) return;
    search.squared = d;
    search.best = node.number;
  };
  if (end - begin <= kLeaf) {
    for (int i = begin; i < end; ++i) look(nodes_[i]);
    return;
  }
  const int middle = (begin + end) / 2, axis = axis_[middle];
  const double side = search.place[axis] - nodes_[middle].point.place[axis];
  const auto visit = [&](bool low) { low ? look_in(begin, middle, search) : look_in(middle + 1, end, search); };
  visit(side <= 0);
  if (side * side > search.squared) return;
  look(nodes_[middle]);
  visit(side > 0);
}

}  // namespace limber
