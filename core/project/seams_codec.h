// SPDX-License-Identifier: AGPL-3.0-or-later
// Seams as bytes and back: the grid's size, then for each axis the voxels whose face towards higher x, y or z is cut,
// by their index in the grid, rising.
#pragma once

#include <functional>

#include "core/base/bytes.h"
#include "core/volume/label_volume.h"
#include "core/volume/seams.h"

namespace limber {

void put(ByteWriter& out, const Seams& seams);
//   take_memory  is told how many bytes are needed before they are, and may throw
Seams get_seams(ByteReader& in, const std::function<void(std::int64_t)>& take_memory);

// Whether the seams are of the volume's grid and lie between tissue alone.
bool fit(const Seams& seams, const LabelVolume& volume);

}  // namespace limber
