// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of the region that limits brushes and weight edits.
#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/paint_region.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_edits.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_paint(const Context& context) {
  if (context.workspace() != Workspace::Skin) return "Switch to the Skin workspace first";
  return why_not_paint(context);
}
std::string needs_rest(const Context& context) {
  const std::string why = needs_paint(context);
  return why.empty() && context.views->scene.pose ? "Show the body at rest first: a region is drawn on the rest pose"
                                                  : why;
}
std::string needs_region(const Context& context) {
  return painted_region(context) ? "" : "No region is set: draw a region first";
}
std::string needs_unmatched(const Context& context) {
  return context.skin->painting->unmatched.empty() ? "Mirror weights found a match for every voxel, or was not run yet"
                                                   : needs_paint(context);
}

void begin(Context& context, std::unique_ptr<Modal> (*tool)(Context&)) {
  context.interaction->modal = tool(context);
  context.interaction->modal_wrap = {};
}

// Sets the region to the voxels where the selected bones together have more than half of the weight.
void region_of_bones(Context& context) {
  change_region(context, "Region of " + painted_name(context), RegionChange::Replace, [](const WeightsToEdit& what) {
    const SkinWeights& weights = *what.document.weights;
    return region_where(*what.tissue, [&](std::int64_t place, const glm::ivec3& voxel) {
      const int brick = what.tissue->brick_at(voxel);
      return 2 * WeightRules::sum_of(weights.chunk(brick)[static_cast<std::size_t>(
                                         place - what.tissue->bricks()[static_cast<std::size_t>(brick)].first)],
                                     what.settings.bones) >
             kFullWeight;
    });
  });
}

void invert_region(Context& context) {
  change_region(context, "Invert region", RegionChange::Replace, [old = painted_region(context)](const WeightsToEdit&) {
    TissueRegion other = *old;
    for (std::uint8_t& one : other) one = !one;
    return other;
  });
}

void region_of_unmatched(Context& context) {
  change_region(context, "Region of unmatched voxels", RegionChange::Replace,
                [places = context.skin->painting->unmatched](const WeightsToEdit& what) {
                  TissueRegion region(static_cast<std::size_t>(what.tissue->size()), 0);
                  for (const std::int64_t place : places)
                    if (place < what.tissue->size()) region[static_cast<std::size_t>(place)] = 1;
                  return region;
                });
}

}  // namespace

std::vector<Operator> region_operators() {
  return {
      {"skin.region_box", "Region by a box", icon::kRegion, "Weights",
       "Limit brushes and edits to a box that you draw over the 3D view or a slice. The box reaches through the whole "
       "body.",
       [](Context& c) { begin(c, begin_region_box); }, needs_rest},
      {"skin.region_lasso", "Region by a lasso", icon::kRegion, "Weights",
       "Limit brushes and edits to an outline that you draw over the 3D view or a slice. The region reaches through "
       "the whole body.",
       [](Context& c) { begin(c, begin_region_lasso); }, needs_rest},
      {"skin.region_bone", "Region of selected bones", icon::kRegion, "Weights",
       "Limit brushes and edits to where the selected bones have most of the weight.", region_of_bones, needs_paint},
      {"skin.region_invert", "Invert region", "", "Weights",
       "Limit brushes and edits to the tissue outside the current region.", invert_region, needs_region},
      {"skin.region_unmatched", "Region of unmatched voxels", icon::kWarning, "Weights",
       "Limit brushes and edits to the voxels for which Mirror weights found no match on the other side.",
       region_of_unmatched, needs_unmatched},
      {"skin.region_clear", "Clear region", icon::kClose, "Weights",
       "Remove the region, so that brushes and edits change the whole body again.", clear_region, needs_region},
  };
}

}  // namespace limber::editor
