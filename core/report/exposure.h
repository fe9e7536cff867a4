// SPDX-License-Identifier: AGPL-3.0-or-later
// What a pose opened to the air, and what it closed off from it, judged from the volumes and the displacement alone.
//   newly exposed  posed voxels at the outside air that are not skin and lay deep at rest: further from the rest's outside air than
//                  a voxel's diagonal and a voxel's edge together, so that rounding at a surface does not count
//   trapped        air that tissue encloses
#pragma once

#include <map>
#include <optional>

#include "core/base/zeroed_vector.h"
#include "core/report/judged_pose.h"

namespace limber {

struct Exposure {
  std::int64_t voxels = 0;          // newly exposed
  std::int64_t surface_voxels = 0;  // posed tissue with a face at the outside air
  double deeper_than_mm = 0;        // what counted as deep at rest
  std::map<Label, std::int64_t> by_label;
  std::optional<WorstPlace> worst;  // none where nothing is exposed

  double percent() const { return surface_voxels ? 100.0 * double(voxels) / double(surface_voxels) : 0; }
};
// Needs the displacement.
Exposure measure_exposure(const JudgedPose& pose);

// The largest pocket of air that posed tissue encloses; none where there is none.
std::optional<WorstPlace> largest_air_pocket(const JudgedPose& pose);

// A byte a voxel, not 0 for air that is connected by faces with the air around the grid.
ZeroedVector<std::uint8_t> outside_air(const LabelVolume& volume);

}  // namespace limber
