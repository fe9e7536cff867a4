// SPDX-License-Identifier: AGPL-3.0-or-later
// Distinguishes the air around a body from the air inside it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

// Returns one byte per voxel of the grid, not 0 for outside air. Outside air is connected, through voxel faces, to one
// of the twelve edges of the volume. So the air of a windpipe counts as inside even if a face of the volume cuts the
// body and the windpipe reaches this face. If tissue fills all edges, air connected to any face of the volume is
// outside air.
std::vector<std::uint8_t> outside_air(const LabelVolume& volume);

}  // namespace limber
