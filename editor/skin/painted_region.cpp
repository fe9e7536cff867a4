// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/painted_region.h"

#include "editor/context/context.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"

namespace limber::editor {

std::shared_ptr<const TissueRegion> painted_region(const Context& context) {
  const PaintedRegion& region = context.skin->painting->region;
  return region.places && context.document().volume && region.volume.lock() == context.document().volume ? region.places
                                                                                                         : nullptr;
}

std::int64_t painted_region_voxels(const Context& context) {
  return painted_region(context) ? context.skin->painting->region.voxels : 0;
}

}  // namespace limber::editor
