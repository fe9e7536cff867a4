// SPDX-License-Identifier: AGPL-3.0-or-later
// The region that brushes and edits of weights keep to.
#pragma once

#include <cstdint>
#include <memory>

#include "editor/context/editor.h"
#include "editor/skin/painting.h"

namespace limber::editor {

// Null where none is set, or it was drawn on another volume.
std::shared_ptr<const TissueRegion> painted_region(const Editor& editor);
std::int64_t painted_region_voxels(const Editor& editor);

}  // namespace limber::editor
