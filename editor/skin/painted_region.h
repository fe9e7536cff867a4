// SPDX-License-Identifier: AGPL-3.0-or-later
// Gives access to the region: the part of the body to which the user has limited brushes and weight edits.
#pragma once

#include <cstdint>
#include <memory>

#include "core/skin/weight_edits.h"

namespace limber::editor {

struct Context;

// Returns the region that limits brushes and edits; null if there is none, or if it was drawn on another volume.
std::shared_ptr<const TissueRegion> painted_region(const Context& context);
std::int64_t painted_region_voxels(const Context& context);

}  // namespace limber::editor
