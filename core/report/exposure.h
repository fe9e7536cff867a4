// SPDX-License-Identifier: AGPL-3.0-or-later
// Measures which tissue a pose exposes to the air and which air it encloses, only from the two volumes and the
// displacement between them.
//   newly exposed  posed voxels that touch the outside air, are not skin, and are deep at rest: further from the
//                  outside air than a voxel's diagonal plus its shortest edge, so that rounding at a surface does not
//                  count
//   trapped        air that tissue encloses in the pose but not at rest
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "core/report/judged_pose.h"
#include "core/volume/distance_transform.h"

namespace limber {

// The outside air: all air that is connected with the air around the grid, through voxel faces.
class OutsideAir {
 public:
  explicit OutsideAir(const LabelVolume& volume);
  // Returns true if the voxel is outside air. Every voxel beyond the grid counts as outside air.
  bool contains(const glm::ivec3& voxel) const { return !box_.contains(voxel) || outside_[box_.index(voxel)]; }

 private:
  VoxelBox box_;  // a box around all tissue
  std::vector<bool> outside_;
};

// The outside air around the body at rest and around the posed body.
struct AirAround {
  OutsideAir rest, posed;
};
AirAround air_around(const JudgedPose& pose);

struct Exposure {
  std::int64_t voxels = 0;          // number of newly exposed voxels
  std::int64_t surface_voxels = 0;  // number of posed tissue voxels that share a face with outside air
  double deeper_than_mm = 0;        // depth at rest, mm, beyond which a voxel counts as deep
  std::map<Label, std::int64_t> by_label;
  std::optional<WorstPlace> worst;  // the largest newly exposed area; empty: there is none

  double percent() const { return surface_voxels ? 100.0 * double(voxels) / double(surface_voxels) : 0; }
};
// Counts the newly exposed voxels. `pose` must have the displacement.
Exposure measure_exposure(const JudgedPose& pose, const AirAround& air);

// Returns the largest pocket of air that posed tissue encloses and that was not enclosed at rest. The tissue beside a
// pocket tells where the pocket was at rest. Returns nothing where there is no such pocket.
std::optional<WorstPlace> largest_air_pocket(const JudgedPose& pose, const AirAround& air);

}  // namespace limber
