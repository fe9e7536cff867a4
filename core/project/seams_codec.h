// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes and reads seams as bytes. A seam is the set of voxel faces at which touching tissue is cut. The bytes are the
// grid's size, then for each axis the ascending grid indices of the voxels whose face towards higher x, y or z is cut.
#pragma once

#include <functional>

#include "core/base/bytes.h"
#include "core/volume/label_volume.h"
#include "core/volume/seams.h"

namespace limber {

void put(ByteWriter& out, const Seams& seams);
// Reads seams from the bytes that put() has written.
//   take_memory  is called with the number of bytes that are needed, before they are allocated; it may throw
Seams get_seams(ByteReader& in, const std::function<void(std::int64_t)>& take_memory);

// Returns true if the seams have the volume's grid and lie only between tissue voxels.
bool fit(const Seams& seams, const LabelVolume& volume);

}  // namespace limber
