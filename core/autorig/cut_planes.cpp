// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/cut_planes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/volume/distance_transform.h"

namespace limber {

namespace {

// A face of the tissue's bounding box can be a cut, a plane at which the body is cut off, only if the tissue in it is
// at least this wide, as a share of the box's longest side. Tissue that merely touches the box is narrower.
constexpr double kTouch = 0.03;
// A label counts as inner (inside the body) if its share of the tissue's surface is smaller than this.
constexpr double kRare = 0.02;
// A face of the tissue's bounding box is a cut (a plane at which the body is cut off) if at least this share of its
// voxels has inner labels, which are rare on the tissue's surface. Measured: 0 on soles, 0.6 and more on cuts.
constexpr double kInner = 0.3;
// Distance between a face and the parallel section inside the tissue with which the face is compared, mm.
constexpr double kDeeper = 5;
// A face of the tissue's bounding box is also a cut if its area is at least this share of the area of the section
// kDeeper mm further inside. Measured: 0.5 at most on soles, 0.9 and more on cuts.
constexpr double kStraight = 0.75;

// Returns the share of each label in the tissue's surface. Surface voxels are searched only along rows in x, without
// the two faces of the bounding box that are perpendicular to x.
std::vector<double> surface_shares(const LabelVolume& volume, const VoxelBox& box) {
  std::vector<double> count(65536, 0);
  const int first = box.lowest.x, last = box.lowest.x + box.size.x - 1;
  double all = 0;
  for (int z = 0; z < box.size.z; ++z)
    for (int y = 0; y < box.size.y; ++y) {
      const Label* row = &volume.voxels[volume.grid.index({0, box.lowest.y + y, box.lowest.z + z})];
      for (int x = first + 1; x < last; ++x)
        if (row[x] && (!row[x - 1] || !row[x + 1])) ++count[row[x]], ++all;
    }
  for (double& share : count) share /= std::max(1.0, all);
  return count;
}

struct Layer {
  double tissue = 0, inner = 0;  // number of tissue voxels, and number of those with inner labels (rare on the surface)
};
Layer layer_at(const LabelVolume& volume, const VoxelBox& box, const std::vector<double>& on_surface, int axis,
               int at) {
  Layer layer;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (int j = 0; j < box.size[v]; ++j)
    for (int i = 0; i < box.size[u]; ++i) {
      glm::ivec3 voxel = box.lowest;
      voxel[axis] = at, voxel[u] += i, voxel[v] += j;
      const Label label = volume.at(voxel);
      layer.tissue += label != 0;
      layer.inner += label != 0 && on_surface[label] < kRare;
    }
  return layer;
}

}  // namespace

std::vector<TissueCut> tissue_cuts(const LabelVolume& volume) {
  std::vector<TissueCut> cuts;
  const VoxelBox box = tissue_box(volume);
  if (box.voxel_count() == 0) return cuts;
  const glm::dvec3 spacing = volume.grid.spacing, sides = glm::dvec3(box.size) * spacing;
  const double touch = kTouch * std::max({sides.x, sides.y, sides.z});
  const std::vector<double> on_surface = surface_shares(volume, box);
  for (int axis = 0; axis < 3; ++axis) {
    const int steps = std::max(1, static_cast<int>(std::lround(kDeeper / spacing[axis])));
    if (box.size[axis] <= 2 * steps) continue;
    for (int side : {-1, 1}) {
      const int outermost = side < 0 ? box.lowest[axis] : box.lowest[axis] + box.size[axis] - 1;
      const Layer face = layer_at(volume, box, on_surface, axis, outermost);
      if (face.tissue * spacing[(axis + 1) % 3] * spacing[(axis + 2) % 3] < touch * touch) continue;
      const Layer deeper = layer_at(volume, box, on_surface, axis, outermost - side * steps);
      if (face.inner < kInner * face.tissue && face.tissue < kStraight * deeper.tissue) continue;
      glm::dvec3 on_face(0);
      on_face[axis] = outermost + 0.5 * side;
      const glm::dvec3 normal = double(side) * volume.grid.direction[axis];
      cuts.push_back({normal, glm::dot(normal, world_from_voxel(volume.grid) * on_face)});
    }
  }
  return cuts;
}

double beyond(const std::vector<TissueCut>& cuts, const glm::dvec3& place) {
  double most = -std::numeric_limits<double>::infinity();
  for (const TissueCut& cut : cuts) most = std::max(most, glm::dot(cut.normal, place) - cut.offset);
  return most;
}

void drop_cut_faces(std::vector<SurfacePoint>& points, const std::vector<TissueCut>& cuts, double near) {
  // A surface point faces the cut if the cosine of the angle between its normal and that of the cut is above this.
  constexpr double kFacing = 0.6;
  std::erase_if(points, [&](const SurfacePoint& point) {
    return std::any_of(cuts.begin(), cuts.end(), [&](const TissueCut& cut) {
      return std::abs(glm::dot(cut.normal, point.place) - cut.offset) < near &&
             glm::dot(cut.normal, point.normal) > kFacing;
    });
  });
}

}  // namespace limber
