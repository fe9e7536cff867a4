// SPDX-License-Identifier: AGPL-3.0-or-later
// Returns the region that limits brushes and weight edits.
#pragma once

#include <cstdint>
#include <memory>

#include "editor/context/editor.h"
#include "editor/skin/painting.h"

namespace limber::editor {

// Returns the region; null if no region is set, or if it was drawn on another volume.
std::shared_ptr<const TissueRegion> painted_region(const Editor& editor);
std::int64_t painted_region_voxels(const Editor& editor);

}  // namespace limber::editor
