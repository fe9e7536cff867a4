// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/bones/bone_distance.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limber {

namespace {

constexpr float kFar = 1e4f;  // mm; larger distances are stored as this

// Position of a lattice point between two voxels along one axis: the lower voxel, and the weight of the upper voxel in
// the interpolation, [0, 1].
struct AxisPoint {
  int voxel;
  float share;
};
std::vector<AxisPoint> points_along(int voxels, double spacing, double edge) {
  std::vector<AxisPoint> points(static_cast<int>(std::floor((voxels - 1) * spacing / edge + 1e-9)) + 1);
  for (int i = 0; i < std::ssize(points); ++i) {
    const double place = std::min(i * edge / spacing, voxels - 1.0);
    const double voxel = std::min(std::floor(place + 1e-9), std::max(voxels - 2.0, 0.0));
    points[i] = {static_cast<int>(voxel), static_cast<float>(std::clamp(place - voxel, 0.0, 1.0))};
  }
  return points;
}

// Returns a byte for each point of a finer lattice: 1 if the point lies inside the given voxels, by trilinear
// interpolation.
std::vector<std::uint8_t> refined(const std::vector<std::uint8_t>& voxels, const glm::ivec3& size,
                                  const std::array<std::vector<AxisPoint>, 3>& points) {
  std::vector<std::uint8_t> inside;
  inside.reserve(points[0].size() * points[1].size() * points[2].size());
  const std::int64_t row = size.x, slice = row * size.y;
  for (const AxisPoint& z : points[2])
    for (const AxisPoint& y : points[1])
      for (const AxisPoint& x : points[0]) {
        const std::uint8_t* at = &voxels[x.voxel + row * y.voxel + slice * z.voxel];
        const std::int64_t right = size.x > 1, back = size.y > 1 ? row : 0, up = size.z > 1 ? slice : 0;
        const auto along_x = [&](const std::uint8_t* p) {
          return float(p[0]) + x.share * (float(p[right]) - float(p[0]));
        };
        const auto along_y = [&](const std::uint8_t* p) {
          return along_x(p) + y.share * (along_x(p + back) - along_x(p));
        };
        inside.push_back(along_y(at) + z.share * (along_y(at + up) - along_y(at)) > 0.5f);
      }
  return inside;
}

// Replaces each value by a weighted mean of itself (weight 2) and its two neighbours along one axis (weight 1 each).
void blur(std::vector<float>& values, const glm::ivec3& size, int axis) {
  const std::int64_t step = axis == 0 ? 1 : axis == 1 ? size.x : std::int64_t{size.x} * size.y;
  const std::int64_t block = step * size[axis];
  for (std::int64_t first = 0; first < std::ssize(values); first += block)
    for (std::int64_t line = first; line < first + step; ++line) {
      float before = values[line];
      for (std::int64_t i = line; i < line + block - step; i += step) {
        const float here = values[i];
        values[i] = 0.25f * (before + values[i + step]) + 0.5f * here;
        before = here;
      }
    }
}

}  // namespace

BoneDistance::BoneDistance(const glm::dvec3& spacing, const std::vector<glm::ivec3>& voxels, const VoxelBox& box)
    : lowest_(glm::dvec3(box.lowest) * spacing),
      edge_(std::min({spacing.x, spacing.y, spacing.z})) {
  std::vector<std::uint8_t> inside(box.voxel_count());
  for (const glm::ivec3& v : voxels)
    if (box.contains(v)) inside[box.index(v)] = 1;
  lattice_.size = box.size;
  if (spacing != glm::dvec3(edge_)) {
    const std::array points{points_along(box.size.x, spacing.x, edge_), points_along(box.size.y, spacing.y, edge_),
                            points_along(box.size.z, spacing.z, edge_)};
    inside = refined(inside, box.size, points);
    lattice_.size = glm::ivec3(points[0].size(), points[1].size(), points[2].size());
  }
  mm_ = signed_distance(lattice_, inside, glm::dvec3(edge_));
  // Converts distances between lattice points to distances from the border, which lies halfway between two points.
  const auto half = static_cast<float>(edge_ / 2), least = static_cast<float>(edge_ / 10);
  for (float& d : mm_) d = std::clamp(d + (d > 0 ? -half : half), -kFar, kFar);
  // Blurs the distances, which removes the steps of a surface made of voxels, including the higher steps of thick
  // slices. No lattice point may change its side of the surface.
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < std::lround(spacing[axis] / edge_); ++i) blur(mm_, lattice_.size, axis);
  for (std::int64_t i = 0; i < std::ssize(mm_); ++i)
    mm_[i] = inside[i] ? std::min(mm_[i], -least) : std::max(mm_[i], least);
  least_ = mm_;
  for (const std::int64_t step :
       {std::int64_t{1}, std::int64_t{lattice_.size.x}, std::int64_t{lattice_.size.x} * lattice_.size.y})
    for (std::int64_t i = 0; i + step < std::ssize(least_); ++i) least_[i] = std::min(least_[i], least_[i + step]);
}

bool BoneDistance::holds(const glm::dvec3& place) const {
  const glm::ivec3 last = lattice_.size - 1;
  return place.x >= 0 && place.x < last.x && place.y >= 0 && place.y < last.y && place.z >= 0 && place.z < last.z;
}

std::optional<BoneDistance::Sample> BoneDistance::below(const glm::dvec3& point, double limit) const {
  const glm::dvec3 place = (point - lowest_) / edge_;
  if (!holds(place) || least_[lattice_.index(glm::ivec3(place))] >= limit) return std::nullopt;
  return sample(place);
}

std::optional<BoneDistance::Sample> BoneDistance::at(const glm::dvec3& point) const {
  const glm::dvec3 place = (point - lowest_) / edge_;
  if (!holds(place)) return std::nullopt;
  return sample(place);
}

BoneDistance::Sample BoneDistance::sample(const glm::dvec3& place) const {
  // Truncation rounds down here, since place is not negative; std::floor would be a function call.
  const glm::ivec3 low(place);
  const std::int64_t row = lattice_.size.x, slice = row * lattice_.size.y;
  const float* p = &mm_[lattice_.index(low)];
  const glm::dvec3 f = place - glm::dvec3(low);
  // Interpolates along x, then y, then z. The gradient follows from differences of the interpolated values.
  const double x00 = p[0] + f.x * (p[1] - p[0]), x10 = p[row] + f.x * (p[row + 1] - p[row]);
  const double x01 = p[slice] + f.x * (p[slice + 1] - p[slice]),
               x11 = p[slice + row] + f.x * (p[slice + row + 1] - p[slice + row]);
  const double y0 = x00 + f.y * (x10 - x00), y1 = x01 + f.y * (x11 - x01);
  const double dx0 = (1 - f.y) * (p[1] - p[0]) + f.y * (p[row + 1] - p[row]);
  const double dx1 = (1 - f.y) * (p[slice + 1] - p[slice]) + f.y * (p[slice + row + 1] - p[slice + row]);
  const glm::dvec3 slope(dx0 + f.z * (dx1 - dx0), (1 - f.z) * (x10 - x00) + f.z * (x11 - x01), y1 - y0);
  return {y0 + f.z * (y1 - y0), slope / edge_};
}

double BoneDistance::outside(const glm::dvec3& point) const {
  const glm::dvec3 above = point - lowest_ - edge_ * glm::dvec3(lattice_.size - 1), below = lowest_ - point;
  return std::max({0.0, above.x, above.y, above.z, below.x, below.y, below.z});
}

std::vector<BoneDistance::SurfacePoint> BoneDistance::surface() const {
  std::vector<SurfacePoint> points;
  const double beside = 0.6 * edge_;
  std::int64_t i = 0;
  for (int z = 0; z < lattice_.size.z; ++z)
    for (int y = 0; y < lattice_.size.y; ++y)
      for (int x = 0; x < lattice_.size.x; ++x, ++i)
        if (std::abs(mm_[i]) < beside) points.push_back({lowest_ + edge_ * glm::dvec3(x, y, z), mm_[i]});
  return points;
}

}  // namespace limber
