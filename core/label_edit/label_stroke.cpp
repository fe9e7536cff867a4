// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/label_edit/label_stroke.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace limber {

VoxelBox box_around(const VoxelBox& a, const VoxelBox& b) {
  if (a.size.x == 0) return b;
  if (b.size.x == 0) return a;
  const glm::ivec3 low = glm::min(a.lowest, b.lowest), high = glm::max(a.lowest + a.size, b.lowest + b.size);
  return {low, high - low};
}

LabelStroke::LabelStroke(std::shared_ptr<const LabelVolume> before, LabelStrokeSettings settings,
                         std::shared_ptr<LabelVolume> copy)
    : before_(std::move(before)),
      painted_(copy ? std::move(copy) : std::make_shared<LabelVolume>(*before_)),
      shown_(painted_),
      settings_(std::move(settings)),
      mask_(settings_.mask, before_->grid) {
  if (!(settings_.radius > 0)) throw std::logic_error("a brush needs a positive radius");
}

// Returns the voxels that the brush changes between two positions, in ascending order, and the box of voxels in its
// reach.
std::vector<std::int64_t> LabelStroke::reached(const glm::dvec3& from, const glm::dvec3& to, VoxelBox& box) const {
  const Grid& grid = painted_->grid;
  const AffineTransform to_voxel = voxel_from_world(grid);
  const glm::dmat3 world = world_from_voxel(grid).linear;
  const double radius = settings_.radius;
  // The distance in voxels that the ball reaches along each voxel axis: the length of each row of the inverse map,
  // times the radius.
  const glm::dmat3 rows = glm::transpose(to_voxel.linear);
  const glm::dvec3 reach = radius * glm::dvec3(glm::length(rows[0]), glm::length(rows[1]), glm::length(rows[2]));
  const glm::dvec3 a = to_voxel * from, b = to_voxel * to;
  glm::ivec3 low = glm::max(glm::ivec3(glm::ceil(glm::min(a, b) - reach)), glm::ivec3(0)),
             high = glm::min(glm::ivec3(glm::floor(glm::max(a, b) + reach)), grid.size - 1);
  bool slab = settings_.flat.has_value();
  if (settings_.flat)
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(glm::dot(grid.direction[axis], *settings_.flat)) > 1 - 1e-9) {
        const int layer = static_cast<int>(std::floor(a[axis] + 0.5));
        // A flat brush paints the layer that contains its centre, even if its radius is too small to reach the voxel
        // centres.
        if (layer < 0 || layer >= grid.size[axis]) return box = {}, std::vector<std::int64_t>();
        low[axis] = high[axis] = layer;
        slab = false;
      }
  std::vector<std::int64_t> voxels;
  box = {};
  if (glm::any(glm::lessThan(high, low))) return voxels;
  box = {low, high - low + 1};

  const glm::dvec3 way = to - from;
  // The squared radius is slightly enlarged, so that voxels at the rim count in spite of rounding.
  const double squared_way = glm::dot(way, way), most = radius * radius * (1 + 1e-9);
  double half = 0;  // half the thickness of a flat brush, mm
  if (settings_.flat)
    for (int axis = 0; axis < 3; ++axis) half = std::max(half, std::abs(glm::dot(world[axis], *settings_.flat)) / 2);
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y) {
      const std::int64_t row = grid.index({0, y, z});
      for (int x = low.x; x <= high.x; ++x) {
        const glm::dvec3 off = world * (glm::dvec3(x, y, z) - a);
        if (slab && std::abs(glm::dot(off, *settings_.flat)) > half) continue;
        const double share = squared_way > 0 ? std::clamp(glm::dot(off, way) / squared_way, 0.0, 1.0) : 0;
        glm::dvec3 apart = off - share * way;
        if (settings_.flat) apart -= glm::dot(apart, *settings_.flat) * *settings_.flat;
        if (glm::dot(apart, apart) > most) continue;
        const Label label = painted_->voxels[static_cast<std::size_t>(row + x)];
        if ((label == settings_.label) == settings_.erases && mask_.allows({x, y, z}, label)) voxels.push_back(row + x);
      }
    }
  return voxels;
}

void LabelStroke::to(const glm::dvec3& point) {
  VoxelBox box;
  const std::vector<std::int64_t> voxels = reached(last_.value_or(point), point, box);
  last_ = point;
  last_box_ = voxels.empty() ? VoxelBox{} : box;
  if (voxels.empty()) return;
  touched_ = box_around(touched_, box);
  if (settings_.erases) {
    apply_change(erased_voxels(*painted_, voxels, settings_.label, settings_.erased), *painted_);
  } else {
    for (const std::int64_t voxel : voxels) painted_->voxels[static_cast<std::size_t>(voxel)] = settings_.label;
  }
}

}  // namespace limber
