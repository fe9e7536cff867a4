// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes seams to files and reads them. The file is a label volume on the body's grid, so that any program that shows
// label volumes shows seams. The value of a voxel tells which of its faces are cut: it is the sum of 1 for the face
// towards higher x, 2 towards higher y and 4 towards higher z (voxel axes).
#pragma once

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/volume/label_volume.h"
#include "core/volume/seams.h"

namespace limber {

void write_seams(const Seams& seams, const Grid& grid, const Path& path);

// Reads seams; ignores faces that are not between two tissue voxels of `volume`. Throws Error for a file of another
// kind, for a grid other than the volume's, and for values that are not a sum of 1, 2 and 4.
Seams read_seams(const Path& path, const LabelVolume& volume, Progress& progress = no_progress());

}  // namespace limber
