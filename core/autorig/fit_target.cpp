// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/autorig/fit_target.h"

#include <algorithm>
#include <cmath>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/volume/distance_transform.h"

namespace limber {

namespace {

constexpr double kCells = 380;  // number of cells along the longest side of the tissue's bounding box
constexpr double kRoughCells = 190;
constexpr double kLeastBone = 0.004;  // smallest share of bone in all tissue; less bone tissue than this is no skeleton
constexpr std::int64_t kBoneCells = 6000;

// Returns the centres of at most `most` cells that are filled with tissue, evenly spread over all such cells.
std::vector<glm::dvec3> filled_cells(const Occupancy& occupancy, std::int64_t most) {
  std::vector<std::int64_t> filled;
  for (std::int64_t i = 0; i < std::ssize(occupancy.share); ++i)
    if (occupancy.share[i] >= 0.5f) filled.push_back(i);
  const AffineTransform to_world = world_from_voxel(occupancy.grid);
  const glm::ivec3 size = occupancy.grid.size;
  const std::int64_t count = std::min(most, std::ssize(filled));
  std::vector<glm::dvec3> centres;
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t i = filled[k * std::ssize(filled) / count];
    centres.push_back(to_world * glm::dvec3(i % size.x, i / size.x % size.y, i / (std::int64_t{size.x} * size.y)));
  }
  return centres;
}

std::vector<SurfacePoint> surface_seen(const Occupancy& cells, const std::vector<TissueCut>& cuts) {
  std::vector<SurfacePoint> points = surface_points(cells);
  drop_cut_faces(points, cuts, 1.5 * std::max({cells.grid.spacing.x, cells.grid.spacing.y, cells.grid.spacing.z}));
  return points;
}

}  // namespace

FitTarget make_fit_target(const LabelVolume& volume) {
  const VoxelBox box = tissue_box(volume);
  if (box.voxel_count() == 0)
    throw Error("a volume without tissue cannot be rigged", "every voxel is air", "give a label volume with tissue");
  FitTarget target;
  const glm::dvec3 sides = glm::dvec3(box.size) * volume.grid.spacing;
  const double longest = std::max({sides.x, sides.y, sides.z}), spacing = longest / kCells;
  LabelSet all(65536, 1);
  all[0] = 0;

  target.body = occupancy_of(volume, all, spacing);
  close_body(target.body);
  target.rough_body = coarsened(target.body, longest / kRoughCells);
  target.length = glm::length(sides);
  target.cell = std::max({target.body.grid.spacing.x, target.body.grid.spacing.y, target.body.grid.spacing.z});
  target.cuts = tissue_cuts(volume);
  target.skin.emplace(surface_seen(target.body, target.cuts), longest / 150, target.cuts);
  return target;
}

void add_bone(FitTarget& target, const LabelVolume& volume, const LabelSet& labels) {
  const glm::dvec3 sides = glm::dvec3(tissue_box(volume).size) * volume.grid.spacing;
  const double longest = std::max({sides.x, sides.y, sides.z});
  target.bone_body = occupancy_of(volume, labels, longest / kCells);
  const auto filled = [](const Occupancy& cells) {
    return parallel_sum(std::ssize(cells.share), 1 << 16, [&](std::int64_t begin, std::int64_t end) {
      double sum = 0;
      for (std::int64_t i = begin; i < end; ++i) sum += cells.share[i];
      return sum;
    });
  };
  if (filled(target.bone_body) <= kLeastBone * filled(target.body)) return;
  target.bone.emplace(surface_seen(target.bone_body, target.cuts), longest / 200, target.cuts);
  target.bone_cells = filled_cells(target.bone_body, kBoneCells);
}

bool has_shape(const FitTarget& target) {
  constexpr std::int64_t kLeast = 300;
  return std::ssize(target.skin->points) >= kLeast;
}

bool ends_with_any(const std::string& name, std::initializer_list<const char*> parts) {
  return std::any_of(parts.begin(), parts.end(), [&](const char* part) { return name.ends_with(part); });
}

bool is_digit(const std::string& name) {
  for (const char* word : {"Thumb", "Index", "Middle", "Ring", "Little", "Jaw"})
    if (name.find(word) != std::string::npos) return true;
  return false;
}

std::vector<std::uint8_t> branch_of(const Armature& rig, int root) {
  std::vector<std::uint8_t> in(rig.bones.size(), 0);
  for (int b = root; b < std::ssize(rig.bones); ++b)
    in[b] = b == root || (rig.bones[b].parent >= 0 && in[rig.bones[b].parent]);
  return in;
}

}  // namespace limber
