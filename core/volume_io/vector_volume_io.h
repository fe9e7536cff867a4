// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes displacement fields: three floats per voxel, mm, world axes (LPS), on the grid of a posed volume.
// The file's header states the direction of the displacements: with the key `limber_field_direction` in NRRD, and in a
// sentence in NRRD, MetaImage and NIfTI.
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
  ZeroedVector<glm::vec3> voxels;  // grid.voxel_count() displacements, x fastest
  std::vector<std::string> warnings;
};

// Direction of a field's displacements, stated for the tissue that a posed voxel contains. ToPosed: its posed position
// minus its rest position. ToRest: its rest position minus its posed position, as in ITK and SimpleITK: rest position =
// x + field(x). On one grid, each field is the negative of the other.
enum class FieldDirection { ToPosed, ToRest };
constexpr const char* kFieldDirectionKey = "limber_field_direction";
constexpr const char* kToPosed = "to-posed";
constexpr const char* kToRest = "to-rest";

// Writes a displacement field. Throws Error when the file cannot be written.
//   to_posed   one displacement per voxel of `grid`, posed minus rest position, mm
//   direction  direction in which the displacements are written
void write_displacement_field(const Grid& grid, std::span<const glm::vec3> to_posed, FieldDirection direction,
                              const Path& path);

// Reads a field and returns it as posed minus rest position, whatever direction the header states. Without a stated
// direction, the file is taken to hold posed minus rest. Throws Error when the file is not NRRD with three floats per
// voxel, when data are missing or damaged, and for values that are not finite.
VectorVolume read_vector_volume(const Path& path);

}  // namespace limber
