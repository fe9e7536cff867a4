// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/seams/seam_edits.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace limber {

namespace {

// Offset that is added to blades, in voxels. Without it, a blade that passes exactly through voxel centres would have
// these voxels on neither of its sides.
constexpr glm::dvec3 kAside(1.17e-4, 2.31e-4, 3.43e-4);

// Returns whether the line segment from a to b, which is parallel to a voxel axis, passes through a triangle.
bool passes(const glm::dvec3& a, const glm::dvec3& b, const std::array<glm::dvec3, 3>& triangle) {
  const auto volume = [](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r, const glm::dvec3& s) {
    return glm::dot(glm::cross(q - p, r - p), s - p);
  };
  const double above = volume(triangle[0], triangle[1], triangle[2], a),
               below = volume(triangle[0], triangle[1], triangle[2], b);
  if ((above > 0) == (below > 0) || above == below) return false;
  const bool first = volume(a, b, triangle[0], triangle[1]) > 0, second = volume(a, b, triangle[1], triangle[2]) > 0,
             third = volume(a, b, triangle[2], triangle[0]) > 0;
  return first == second && second == third;
}

struct Box {
  glm::ivec3 low, high;
};
Box voxels_about(const glm::ivec3& size, glm::dvec3 low, glm::dvec3 high) {
  low = glm::clamp(low, glm::dvec3(-1), glm::dvec3(size));
  high = glm::clamp(high, glm::dvec3(-1), glm::dvec3(size));
  return {glm::max(glm::ivec3(glm::floor(low)), glm::ivec3(0)), glm::min(glm::ivec3(glm::ceil(high)), size - 1)};
}

template <class Body>
void for_each_in(const Box& box, const Body& body) {
  glm::ivec3 v;
  for (v.z = box.low.z; v.z <= box.high.z; ++v.z)
    for (v.y = box.low.y; v.y <= box.high.y; ++v.y)
      for (v.x = box.low.x; v.x <= box.high.x; ++v.x) body(v);
}

}  // namespace

LabelSet soft_labels(const TissueTable& tissues) {
  LabelSet soft(65536, 1);
  soft[0] = 0;
  for (const Tissue& tissue : tissues.tissues)
    if (is_bone(tissue.kind)) soft[tissue.label] = 0;
  return soft;
}

std::int64_t cut_between(Seams& seams, const LabelVolume& volume, const LabelSet& soft, const Blade& first,
                         const Blade& second) {
  const AffineTransform voxel = voxel_from_world(volume.grid);
  const std::array<glm::dvec3, 4> corners{voxel * first.from + kAside, voxel * first.to + kAside,
                                          voxel * second.to + kAside, voxel * second.from + kAside};
  const std::array<std::array<glm::dvec3, 3>, 2> sheet{
      {{corners[0], corners[1], corners[2]}, {corners[0], corners[2], corners[3]}}};
  glm::dvec3 low = corners[0], high = corners[0];
  for (const glm::dvec3& corner : corners) low = glm::min(low, corner), high = glm::max(high, corner);
  if (!(glm::length(high - low) < 1e9)) return 0;
  const std::int64_t before = seams.size();
  for_each_in(voxels_about(volume.grid.size, low - 1.0, high), [&](const glm::ivec3& v) {
    if (!soft[volume.at(v)]) return;
    for (int axis = 0; axis < 3; ++axis) {
      glm::ivec3 above = v;
      ++above[axis];
      if (!volume.grid.contains(above) || !soft[volume.at(above)]) continue;
      if (passes(v, above, sheet[0]) || passes(v, above, sheet[1])) seams.cut(v, axis);
    }
  });
  return seams.size() - before;
}

std::int64_t join_within(Seams& seams, const Grid& grid, const glm::dvec3& centre, double radius) {
  const AffineTransform world = world_from_voxel(grid);
  const glm::dvec3 middle = voxel_from_world(grid) * centre, reach = radius / grid.spacing + 1.0;
  const std::int64_t before = seams.size();
  for_each_in(voxels_about(grid.size, middle - reach, middle + reach), [&](const glm::ivec3& v) {
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 face(v);
      face[axis] += 0.5;
      if (seams.is_cut(v, axis) && glm::distance(world * face, centre) <= radius) seams.join(v, axis);
    }
  });
  return before - seams.size();
}

}  // namespace limber
