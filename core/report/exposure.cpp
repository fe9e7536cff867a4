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

// Flood fill of the air inside a box, starting from seed voxels; each step fills a whole run of air voxels along x.
class AirFlood {
 public:
  AirFlood(const LabelVolume& volume, const VoxelBox& box, std::vector<bool>& outside)
      : volume_(volume),
        box_(box),
        outside_(outside) {}

  void start(const glm::ivec3& v) {
    if (!is_new(v)) return;
    seeds_.push_back(v);
    while (!seeds_.empty()) {
      const glm::ivec3 seed = seeds_.back();
      seeds_.pop_back();
      if (is_new(seed)) fill_row(seed);
    }
  }

 private:
  bool is_new(const glm::ivec3& v) const { return volume_.at(v) == 0 && !outside_[box_.index(v)]; }

  void fill_row(const glm::ivec3& seed) {
    const int low = box_.lowest.x, high = low + box_.size.x;
    int begin = seed.x, end = seed.x + 1;
    while (begin > low && is_new({begin - 1, seed.y, seed.z})) --begin;
    while (end < high && is_new({end, seed.y, seed.z})) ++end;
    const auto row = outside_.begin() + box_.index({begin, seed.y, seed.z});
    std::fill(row, row + (end - begin), true);
    for (const auto& [dy, dz] : {std::array{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      const glm::ivec3 beside{begin, seed.y + dy, seed.z + dz};
      if (box_.contains(beside)) seed_row(beside, end);
    }
  }

  // Adds a seed for each run of air voxels that is not filled yet. Looks only at x = from.x .. end - 1 of one row.
  void seed_row(const glm::ivec3& from, int end) {
    const Label* labels = volume_.voxels.data() + volume_.grid.index(from);
    const std::int64_t outside = box_.index(from);
    bool before = false;
    for (int k = 0; k < end - from.x; ++k) {
      const bool now = labels[k] == 0 && !outside_[outside + k];
      if (now && !before) seeds_.push_back({from.x + k, from.y, from.z});
      before = now;
    }
  }

  const LabelVolume& volume_;
  const VoxelBox& box_;
  std::vector<bool>& outside_;
  std::vector<glm::ivec3> seeds_;
};

// Returns the offsets from a voxel to all voxels whose centres are at most `reach` mm away, the nearest first.
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

// Returns the position in the middle of the largest connected component of the given voxels; nothing if there are none.
//   voxels  indices into the posed grid, ascending
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

OutsideAir::OutsideAir(const LabelVolume& volume)
    : box_(tissue_box(volume, 1)),
      outside_(static_cast<std::size_t>(box_.voxel_count())) {
  AirFlood flood(volume, box_, outside_);
  const glm::ivec3 low = box_.lowest, high = box_.lowest + box_.size - 1;
  for (int z = low.z; z <= high.z; ++z)
    for (int y = low.y; y <= high.y; ++y) {
      const bool border = y == low.y || z == low.z || y == high.y || z == high.z;
      for (int x = low.x; x <= high.x; x += border || box_.size.x == 1 ? 1 : box_.size.x - 1) flood.start({x, y, z});
    }
}

AirAround air_around(const JudgedPose& pose) {
  std::array<std::optional<OutsideAir>, 2> air;
  parallel_for(2, 1, [&](std::int64_t which, std::int64_t) { air[which].emplace(which ? pose.posed : pose.rest); });
  return {std::move(*air[0]), std::move(*air[1])};
}

Exposure measure_exposure(const JudgedPose& pose, const AirAround& air) {
  const Grid &rest_grid = pose.rest.grid, &grid = pose.posed.grid;
  const std::vector<TissueKind> kinds = pose.tissues.kinds();
  Exposure exposure;
  exposure.deeper_than_mm =
      glm::length(rest_grid.spacing) + std::min({rest_grid.spacing.x, rest_grid.spacing.y, rest_grid.spacing.z});
  const std::vector<glm::ivec3> near = ball(rest_grid.spacing, exposure.deeper_than_mm);
  const AffineTransform to_rest = voxel_from_world(rest_grid);

  const auto was_deep = [&](const glm::ivec3& v) {
    const glm::ivec3 rest(glm::floor(to_rest * pose.rest_place(v) + 0.5));
    return std::none_of(near.begin(), near.end(),
                        [&](const glm::ivec3& step) { return air.rest.contains(rest + step); });
  };
  std::vector<SurfaceOfSlice> slices(grid.size.z);
  parallel_for(grid.size.z, 1, [&](std::int64_t z, std::int64_t) {
    std::int64_t at = grid.index({0, 0, int(z)});
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x, ++at) {
        const Label label = pose.posed.voxels[at];
        const glm::ivec3 v(x, y, z);
        if (label == 0 || std::none_of(kFaces.begin(), kFaces.end(),
                                       [&](const glm::ivec3& face) { return air.posed.contains(v + face); }))
          continue;
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

std::optional<WorstPlace> largest_air_pocket(const JudgedPose& pose, const AirAround& air) {
  const Grid& grid = pose.posed.grid;
  const AffineTransform to_rest = voxel_from_world(pose.rest.grid);
  // Returns true if an enclosed air voxel of the pose was enclosed at rest too. Air has no displacement, so the
  // displacement of the tissue beside the voxel tells where the voxel was at rest.
  const auto was_enclosed = [&](const glm::ivec3& v) {
    for (const glm::ivec3& face : kFaces) {
      const glm::ivec3 beside = v + face;
      if (pose.posed.at_or_air(beside) == 0) continue;
      const glm::dvec3 moved = pose.knows_field() ? glm::dvec3(pose.displacement.at(grid, beside)) : glm::dvec3(0);
      const glm::ivec3 rest(glm::floor(to_rest * (pose.posed_place(v) - moved) + 0.5));
      if (pose.rest.at_or_air(rest) == 0 && !air.rest.contains(rest)) return true;
    }
    return false;
  };
  std::vector<std::int64_t> enclosed;
  std::int64_t at = 0;
  for (int z = 0; z < grid.size.z; ++z)
    for (int y = 0; y < grid.size.y; ++y)
      for (int x = 0; x < grid.size.x; ++x, ++at)
        if (pose.posed.voxels[at] == 0 && !air.posed.contains({x, y, z}) && !was_enclosed({x, y, z}))
          enclosed.push_back(at);
  return worst_of(pose, enclosed);
}

std::string nearest_posed_bone(const JudgedPose& pose, const glm::dvec3& place) {
  std::string nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t b = 0; pose.armature && b < pose.armature->bones.size(); ++b)
    if (const double away = distance_to_bone(pose.armature->bones[b], inverse(pose.applied[b]) * place); away < least)
      least = away, nearest = pose.armature->bones[b].name;
  return nearest;
}

}  // namespace limber
