// SPDX-License-Identifier: AGPL-3.0-or-later
// Tells the air around a body from the air inside it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

// Returns a byte per voxel of the grid, not 0 for outside air: air that is connected through voxel faces to one of the
// twelve edges of the volume. Where a face of the volume cuts a body, a windpipe may reach that face but no edge, so
// its air counts as inside. When tissue fills all edges, air connected to any face of the volume counts as outside.
std::vector<std::uint8_t> outside_air(const LabelVolume& volume);

}  // namespace limber
