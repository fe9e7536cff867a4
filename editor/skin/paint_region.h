// SPDX-License-Identifier: AGPL-3.0-or-later
// The region of the body that brushes and edits of weights keep to, drawn over a view as a box or a lasso: what lies in
// it from front to back, at rest. It belongs to the volume that it was drawn on, and is no part of the document; the
// views dull what lies outside.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/skin/weight_edits.h"
#include "editor/context/modal_tool.h"
#include "editor/skin/painted_region.h"

namespace limber::editor {

struct WeightsToEdit;

// What becomes of the region that is there.
enum class RegionChange { Replace, Add, TakeOut, Common };

using WhereOfRegion = std::function<TissueRegion(const WeightsToEdit&)>;
// Beside the editor where the body is large. A region without a voxel is none: that is told and the old one stays.
void change_region(Editor& editor, const std::string& label, RegionChange change, const WhereOfRegion& where);
void clear_region(Editor& editor);

std::unique_ptr<Modal> begin_region_box(Editor& editor);
std::unique_ptr<Modal> begin_region_lasso(Editor& editor);

}  // namespace limber::editor
