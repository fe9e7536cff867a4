// SPDX-License-Identifier: AGPL-3.0-or-later
// Asks for large memory pages for a new label volume. All pages of a limb's volume are soon read or written, even those
// with only air, and one page fault for 2 MB takes far less time than 512 page faults for 4 KB each. The volume of a
// whole body keeps small pages: with these, air that is only read takes no memory.
#pragma once

#include "core/platform/memory_pages.h"
#include "core/volume/label_volume.h"

namespace limber {

// Asks the system for large memory pages for the labels of volumes of at most 32 million voxels; does nothing for
// larger volumes. Call it before labels are written.
inline void want_large_pages(LabelVolume& volume) {
  constexpr std::size_t kMost = 32'000'000;
  const std::size_t voxels = volume.voxels.size();
  if (voxels <= kMost) want_large_pages(volume.voxels.data(), static_cast<std::int64_t>(voxels * sizeof(Label)));
}

}  // namespace limber
