// SPDX-License-Identifier: AGPL-3.0-or-later
// Changes the region of the body that limits brushes and weight edits. The user draws a box or a lasso over a view; the
// region is all tissue of the rest pose behind the drawn area, at any depth. The region belongs to the volume that it
// was drawn on and is not part of the document. The views dim the tissue outside the region.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/skin/weight_edits.h"
#include "editor/context/modal_tool.h"
#include "editor/skin/painted_region.h"

namespace limber::editor {

struct Context;
struct WeightsToEdit;

// How a new region combines with the existing region. TakeOut: the new one is subtracted. Common: the intersection.
enum class RegionChange { Replace, Add, TakeOut, Common };

using WhereOfRegion = std::function<TissueRegion(const WeightsToEdit&)>;
// Combines the region that `where` returns with the existing region; runs in a background task if the body is large. If
// the combined region has no voxel, warns the user and keeps the existing region.
void change_region(Context& context, const std::string& label, RegionChange change, const WhereOfRegion& where);
void clear_region(Context& context);

std::unique_ptr<Modal> begin_region_box(Context& context);
std::unique_ptr<Modal> begin_region_lasso(Context& context);

}  // namespace limber::editor
