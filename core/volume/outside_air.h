// SPDX-License-Identifier: AGPL-3.0-or-later
// Which air lies around a body, and which inside of it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/volume/label_volume.h"

namespace limber {

// A byte per voxel of the grid, not 0 for air that faces of air join to one of the twelve edges of the volume's box.
// Where a body is cut by a side of the box, a windpipe opens into that side but reaches no edge: its air is the body's.
// Where tissue fills all the edges, air that is joined to a side counts.
std::vector<std::uint8_t> outside_air(const LabelVolume& volume);

}  // namespace limber
