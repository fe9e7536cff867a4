// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads displacement fields as write_vector_volume writes them: NRRD with three floats a voxel, mm, world axes.
#pragma once

#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/base/zeroed_vector.h"
#include "core/volume/grid.h"

namespace limber {

struct VectorVolume {
  Grid grid;
  ZeroedVector<glm::vec3> voxels;  // grid.voxel_count(), x fastest
  std::vector<std::string> warnings;
};

// Throws Error for what is no NRRD file of three floats a voxel, for missing or damaged data, and for values that are
// not finite.
VectorVolume read_vector_volume(const Path& path);

}  // namespace limber
