// SPDX-License-Identifier: AGPL-3.0-or-later
// Displacement fields: three floats a voxel, mm, world axes (LPS), on the grid of a posed volume. Which way they point
// is said in the file's header: the key `limber_field_direction` of NRRD, and a sentence in NRRD, MetaImage and NIfTI.
#pragma once

#include <span>
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

// ToPosed: from the rest place of what a voxel holds to the voxel, posed minus rest. ToRest: from the voxel to that
// rest place, as ITK and SimpleITK take it: posed(x) = rest(x + field(x)). Each is the other's negative, on the same
// grid.
enum class FieldDirection { ToPosed, ToRest };
constexpr const char* kFieldDirectionKey = "limber_field_direction";
constexpr const char* kToPosed = "to-posed";
constexpr const char* kToRest = "to-rest";

//   to_posed  grid.voxel_count() displacements, posed minus rest, written in the direction that is asked for
//   throws Error when the file cannot be written
void write_displacement_field(const Grid& grid, std::span<const glm::vec3> to_posed, FieldDirection direction,
                              const Path& path);

// Always posed minus rest, whatever the file's header says that it holds; a header that says nothing means that.
// Throws Error for what is no NRRD file of three floats a voxel, for missing or damaged data, and for values that are
// not finite.
VectorVolume read_vector_volume(const Path& path);

}  // namespace limber
