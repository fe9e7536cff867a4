// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes displacement fields: three floats per voxel, mm, world axes (LPS), on the grid of a posed volume.
// The file's header states their direction: the key `limber_field_direction` in NRRD, and a sentence in NRRD, MetaImage
// and NIfTI.
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

// Direction of a field's displacements. ToPosed: posed position minus rest position of what a posed voxel contains.
// ToRest: rest position minus posed position, as ITK and SimpleITK use it: posed(x) = rest(x + field(x)). Each is the
// negative of the other, on the same grid.
enum class FieldDirection { ToPosed, ToRest };
constexpr const char* kFieldDirectionKey = "limber_field_direction";
constexpr const char* kToPosed = "to-posed";
constexpr const char* kToRest = "to-rest";

// Writes a field. Throws Error when the file cannot be written.
//   to_posed   one displacement per voxel of `grid`, posed minus rest
//   direction  direction in which the displacements are written
void write_displacement_field(const Grid& grid, std::span<const glm::vec3> to_posed, FieldDirection direction,
                              const Path& path);

// Reads a field and returns it as posed minus rest, whatever direction the file's header states. A file that states
// none is posed minus rest. Throws Error when the file is not NRRD with three floats per voxel, when data are missing
// or damaged, and for values that are not finite.
VectorVolume read_vector_volume(const Path& path);

}  // namespace limber
