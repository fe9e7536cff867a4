// SPDX-License-Identifier: AGPL-3.0-or-later
// Asks for large memory pages for a new label volume. Every page of a limb's volume is soon read or written, air too,
// and one page fault for 2 MB takes far less time than 512 for 4 KB each. Large bodies get small pages: air that is
// only read uses no memory there, but would with large pages.
#pragma once

#include "core/base/memory_pages.h"
#include "core/volume/label_volume.h"

namespace limber {

// Asks for large pages for volumes of at most 32 million voxels; call it before labels are written.
inline void want_large_pages(LabelVolume& volume) {
  constexpr std::size_t kMost = 32'000'000;
  const std::size_t voxels = volume.voxels.size();
  if (voxels <= kMost) want_large_pages(volume.voxels.data(), static_cast<std::int64_t>(voxels * sizeof(Label)));
}

}  // namespace limber
