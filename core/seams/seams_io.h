// SPDX-License-Identifier: AGPL-3.0-or-later
// Seams to and from files: a label volume on the body's grid whose voxels say which of their faces are cut, the sum of
// 1 for the face towards higher x, 2 towards higher y, 4 towards higher z (voxel axes). So any program that shows label
// volumes shows them.
#pragma once

#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/volume/label_volume.h"
#include "core/volume/seams.h"

namespace limber {

void write_seams(const Seams& seams, const Grid& grid, const Path& path);

// Only faces between two tissue voxels of `volume` count.
// throws Error for what is no such file, another grid, and values that are no sum of 1, 2 and 4
Seams read_seams(const Path& path, const LabelVolume& volume, Progress& progress = no_progress());

}  // namespace limber
