// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of the region that limits brushes and weight edits.
#include "editor/context/operator.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/paint_region.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_edits.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_paint(const Editor& editor) {
  if (editor.workspace != Workspace::Skin) return "Switch to the Skin workspace first";
  return why_not_paint(editor);
}
std::string needs_rest(const Editor& editor) {
  const std::string why = needs_paint(editor);
  return why.empty() && editor.views->scene.pose ? "Show the body at rest first: a region is drawn on the rest pose"
                                                 : why;
}
std::string needs_region(const Editor& editor) { return painted_region(editor) ? "" : "No region is set"; }
std::string needs_unmatched(const Editor& editor) {
  return editor.skin->painting->unmatched.empty() ? "Mirror weights found a match for every voxel, or was not run yet"
                                                  : needs_paint(editor);
}

void begin(Editor& editor, std::unique_ptr<Modal> (*tool)(Editor&)) {
  editor.modal = tool(editor);
  editor.modal_wrap = {};
}

// Sets the region to the voxels where the selected bones together have more than half of the weight.
void region_of_bones(Editor& editor) {
  change_region(editor, "Region of " + painted_name(editor), RegionChange::Replace, [](const WeightsToEdit& what) {
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

void invert_region(Editor& editor) {
  change_region(editor, "Invert region", RegionChange::Replace, [old = painted_region(editor)](const WeightsToEdit&) {
    TissueRegion other = *old;
    for (std::uint8_t& one : other) one = !one;
    return other;
  });
}

void region_of_unmatched(Editor& editor) {
  change_region(editor, "Region of unmatched voxels", RegionChange::Replace,
                [places = editor.skin->painting->unmatched](const WeightsToEdit& what) {
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
       [](Editor& e) { begin(e, begin_region_box); }, needs_rest},
      {"skin.region_lasso", "Region by a lasso", icon::kRegion, "Weights",
       "Limit brushes and edits to an outline that you draw over the 3D view or a slice. The region reaches through "
       "the whole body.",
       [](Editor& e) { begin(e, begin_region_lasso); }, needs_rest},
      {"skin.region_bone", "Region of bone", icon::kRegion, "Weights",
       "Limit brushes and edits to where the selected bones have most of the weight.", region_of_bones, needs_paint},
      {"skin.region_invert", "Invert region", "", "Weights",
       "Limit brushes and edits to what lies outside the current region.", invert_region, needs_region},
      {"skin.region_unmatched", "Region of unmatched voxels", icon::kWarning, "Weights",
       "Limit brushes and edits to the voxels for which Mirror weights found no match on the other side.",
       region_of_unmatched, needs_unmatched},
      {"skin.region_clear", "Clear region", icon::kClose, "Weights",
       "Remove the region, so that brushes and edits change the whole body again.", clear_region, needs_region},
  };
}

}  // namespace limber::editor
