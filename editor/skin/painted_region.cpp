// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/painted_region.h"

#include "editor/skin/weight_display.h"

namespace limber::editor {

std::shared_ptr<const TissueRegion> painted_region(const Editor& editor) {
  const PaintedRegion& region = editor.skin->painting->region;
  return region.places && editor.document().volume && region.volume.lock() == editor.document().volume ? region.places
                                                                                                       : nullptr;
}

std::int64_t painted_region_voxels(const Editor& editor) {
  return painted_region(editor) ? editor.skin->painting->region.voxels : 0;
}

}  // namespace limber::editor
