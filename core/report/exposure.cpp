// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/report/exposure.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "core/base/parallel.h"
#include "core/report/voxel_pieces.h"

namespace limber {

namespace {
constexpr std::array<glm::ivec3, 6> kFaces = {{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

// Fills air from seeds, a stretch along x at a time.
class AirFlood {
 public:
  AirFlood(const LabelVolume& volume, ZeroedVector<std::uint8_t>& outside) : volume_(volume), outside_(outside) {}

  void start(const glm::ivec3& v) {
    if (!is_new(volume_.grid.index(v))) return;
    seeds_.push_back(v);
    while (!seeds_.empty()) {
      const glm::ivec3 seed = seeds_.back();
      seeds_.pop_back();
      fill_row(seed);
    }
  }

 private:
  bool is_new(std::int64_t at) const { return volume_.voxels[at] == 0 && !outside_[at]; }

  void fill_row(const glm::ivec3& seed) {
    const std::int64_t row = volume_.grid.index({0, seed.y, seed.z});
    if (!is_new(row + seed.x)) return;
    int begin = seed.x, end = seed.x + 1;
    while (begin > 0 && is_new(row + begin - 1)) --begin;
    while (end < volume_.grid.size.x && is_new(row + end)) ++end;
    std::fill(outside_.begin() + row + begin, outside_.begin() + row + end, std::uint8_t{1});
    for (const auto& [dy, dz] : {std::array{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const glm::ivec3 beside{begin, seed.y + dy, seed.z + dz};
      if (volume_.grid.contains(beside)) seed_row(beside, end);
    }
  }

  // One seed for each stretch of air of a row between from.x and `end`.
  void seed_row(glm::ivec3 from, int end) {
    const std::int64_t row = volume_.grid.index({0, from.y, from.z});
    for (bool before = false; from.x < end; ++from.x) {
      const bool now = is_new(row + from.x);
      if (now && !before) seeds_.push_back(from);
      before = now;
    }
  }

  const LabelVolume& volume_;
  ZeroedVector<std::uint8_t>& outside_;
  std::vector<glm::ivec3> seeds_;
};

// Steps to all voxels whose centre is at most `reach` mm away, the nearest first.
std::vector<glm::ivec3> ball(const glm::dvec3& spacing, double reach) {
  const glm::ivec3 most(glm::dvec3(reach) / spacing + 1e-9);
  std::vector<glm::ivec3> steps;
  for (int z = -most.z; z <= most.z; ++z)
    for (int y = -most.y; y <= most.y; ++y)
      for (int x = -most.x; x <= most.x; ++x)
        if (glm::length(glm::dvec3(x, y, z) * spacing) <= reach) steps.emplace_back(x, y, z);
  std::stable_sort(steps.begin(), steps.end(), [&](const glm::ivec3& a, const glm::ivec3& b) {
    return glm::length(glm::dvec3(a) * spacing) < glm::length(glm::dvec3(b) * spacing);
  });
  return steps;
}

// Beyond the grid is air.
bool is_outside(const Grid& grid, const ZeroedVector<std::uint8_t>& outside, const glm::ivec3& v) { return !grid.contains(v) || outside[grid.index(v)]; }

//   voxels  of the posed grid, ascending
std::optional<WorstPlace> worst_of(const JudgedPose& pose, const std::vector<std::int64_t>& voxels) {
  if (voxels.empty()) return std::nullopt;
  const auto largest = pieces_of(pose.posed.grid, voxels).front();
  const glm::dvec3 place = pose.posed_place(middle_voxel(pose.posed.grid, voxels, largest));
  return WorstPlace{std::ssize(largest), place, nearest_posed_bone(pose, place)};
}

struct SurfaceOfSlice {
  std::int64_t surface_voxels = 0;
  std::vector<std::int64_t> exposed;
};
}  // namespace

ZeroedVector<std::uint8_t> outside_air(const LabelVolume& volume) {
  const glm::ivec3 size = volume.grid.size;
  ZeroedVector<std::uint8_t> outside(volume.voxels.size());
  AirFlood flood(volume, outside);
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y) {
      const bool border = y == 0 || z == 0 || y == size.y - 1 || z == size.z - 1;
      for (int x = 0; x < size.x; x += border || size.x == 1 ? 1 : size.x - 1) flood.start({x, y, z});
    }
  return outside;
}

Exposure measure_exposure(const JudgedPose& pose) {
  const Grid &rest_grid = pose.rest.grid, &grid = pose.posed.grid;
  ZeroedVector<std::uint8_t> outside_rest, outside_posed;
  parallel_for(2, 1, [&](std::int64_t which, std::int64_t) { (which ? outside_posed : outside_rest) = outside_air(which ? pose.posed : pose.rest); });
  const std::vector<TissueKind> kinds = pose.tissues.kinds();
  Exposure exposure;
  exposure.deeper_than_mm = glm::length(rest_grid.spacing) + std::min({rest_grid.spacing.x, rest_grid.spacing.y, rest_grid.spacing.z});
  const std::vector<glm::ivec3> near = ball(rest_grid.spacing, exposure.deeper_than_mm);
  const AffineTransform to_rest = voxel_from_world(rest_grid);

  const auto was_deep = [&](const glm::ivec3& v) {
    const glm::ivec3 rest(glm::floor(to_rest * pose.rest_place(v) + 0.5));
    return std::none_of(near.begin(), near.end(), [&](const glm::ivec3& step) { return is_outside(rest_grid, outside_rest, rest + step); });
  };
  std::vector<SurfaceOfSlice> slices(grid.size.z);
  parallel_for(grid.size.z, 1, [&](std::int64_t z, std::int64_t) {
    std::int64_t at = grid.index({0, 0, int(z)});
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x, ++at) {
        const Label label = pose.posed.voxels[at];
        const glm::ivec3 v(x, y, z);
        if (label == 0 || std::none_of(kFaces.begin(), kFaces.end(), [&](const glm::ivec3& face) { return is_outside(grid, outside_posed, v + face); })) continue;
        ++slices[z].surface_voxels;
        if (kinds[label] != TissueKind::Skin && was_deep(v)) slices[z].exposed.push_back(at);
      }
  });
  std::vector<std::int64_t> exposed;
  for (const SurfaceOfSlice& slice : slices) {
    exposure.surface_voxels += slice.surface_voxels;
    exposed.insert(exposed.end(), slice.exposed.begin(), slice.exposed.end());
  }
  exposure.voxels = std::ssize(exposed);
  for (const std::int64_t at : exposed) ++exposure.by_label[pose.posed.voxels[at]];
  exposure.worst = worst_of(pose, exposed);
  return exposure;
}

std::optional<WorstPlace> largest_air_pocket(const JudgedPose& pose) {
  const LabelVolume& volume = pose.posed;
  const ZeroedVector<std::uint8_t> outside = outside_air(volume);
  std::vector<std::int64_t> enclosed;
  for (std::int64_t at = 0; at < std::ssize(volume.voxels); ++at)
    if (volume.voxels[at] == 0 && !outside[at]) enclosed.push_back(at);
  return worst_of(pose, enclosed);
}

std::string nearest_posed_bone(const JudgedPose& pose, const glm::dvec3& place) {
  std::string nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; pose.armature && b < pose.armature->bones.size(); ++b)
    if (const double away = distance_to_bone(pose.armature->bones[b], inverse(pose.applied[b]) * place); away < least) least = away, nearest = pose.armature->bones[b].name;
  return nearest;
}

}  // namespace limber
