// SPDX-License-Identifier: AGPL-3.0-or-later
// What a pose opened to the air, and what it closed off from it, judged from the volumes and the displacement alone.
//   newly exposed  posed voxels at the outside air that are not skin and lay deep at rest: further from the rest's
//   outside air than
//                  a voxel's diagonal and a voxel's edge together, so that rounding at a surface does not count
//   trapped        air that tissue encloses
#pragma once

#include <map>
#include <optional>

#include "core/report/judged_pose.h"
#include "core/volume/distance_transform.h"

namespace limber {

// The air that is connected by faces with the air around the grid.
class OutsideAir {
 public:
  explicit OutsideAir(const LabelVolume& volume);
  // Beyond the grid is air.
  bool contains(const glm::ivec3& voxel) const { return !box_.contains(voxel) || outside_[box_.index(voxel)]; }

 private:
  VoxelBox box_;  // around all tissue
  std::vector<std::uint8_t> outside_;
};

// Of a body at rest and posed.
struct AirAround {
  OutsideAir rest, posed;
};
AirAround air_around(const JudgedPose& pose);

struct Exposure {
  std::int64_t voxels = 0;          // newly exposed
  std::int64_t surface_voxels = 0;  // posed tissue with a face at the outside air
  double deeper_than_mm = 0;        // what counted as deep at rest
  std::map<Label, std::int64_t> by_label;
  std::optional<WorstPlace> worst;  // none where nothing is exposed

  double percent() const { return surface_voxels ? 100.0 * double(voxels) / double(surface_voxels) : 0; }
};
// Needs the displacement.
Exposure measure_exposure(const JudgedPose& pose, const AirAround& air);

// The largest pocket of air that posed tissue encloses and that was not enclosed at rest, as the tissue beside it
// tells; none where there is none.
std::optional<WorstPlace> largest_air_pocket(const JudgedPose& pose, const AirAround& air);

}  // namespace limber
