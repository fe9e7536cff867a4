// SPDX-License-Identifier: AGPL-3.0-or-later
// Large pages under a fresh label volume. Every page of a limb is soon read or written, air too, and one fault for 2 MB
// costs far less than 512. The air of a large body takes no memory while it is only read, and large pages would take
// it.
#pragma once

#include "core/base/memory_pages.h"
#include "core/volume/label_volume.h"

namespace limber {

// Of volumes of at most 32 million voxels; to be called before labels are written.
inline void want_large_pages(LabelVolume& volume) {
  constexpr std::size_t kMost = 32'000'000;
  const std::size_t voxels = volume.voxels.size();
  if (voxels <= kMost) want_large_pages(volume.voxels.data(), static_cast<std::int64_t>(voxels * sizeof(Label)));
}

}  // namespace limber
