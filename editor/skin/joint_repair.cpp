// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/joint_repair.h"

#include <algorithm>
#include <cstdio>

#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/seams/seam_view.h"
#include "editor/shown/preview_blend.h"
#include "editor/shown/test_pose.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/painting.h"
#include "editor/skin/weight_display.h"
#include "editor/skin/weight_layers.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

constexpr char kRepairing[] = "Repair joint";

// Returns the document's layers with a new layer on top. The new layer has the repaired weights in the voxels that the
// repair has changed.
EditedLayers on_own_layer(const LayerToEdit& edited, const std::string& name, const SkinWeights& repaired) {
  const WeightLayers before = edited.layers ? *edited.layers : WeightLayers{edited.came_out, {}};
  WeightLayers layers = with_new_layer(before, name);
  layers.layers.back() =
      std::make_shared<const WeightLayer>(painted_on(*layers.layers.back(), *edited.came_out, repaired));
  auto came_out = std::make_shared<const SkinWeights>(recomposed(layers, before, *edited.came_out));
  return {came_out, std::make_shared<const WeightLayers>(std::move(layers)), came_out};
}

std::string gain_of(const JointRepair& figures) {
  char text[128];
  std::snprintf(text, sizeof text, "Volumes of skin, fat and muscle change by %.2f %% instead of %.2f %%",
                mean_sum(figures.after), mean_sum(figures.before));
  return text;
}

}  // namespace

void start_repairing_joint(Context& context) {
  const Document of = context.document();
  const int bone = *skin_bone(context);
  const JointRepairSettings settings{.range = {},
                                     .blend = preview_blend(context.resampling),
                                     .locked = stroke_settings(context, BrushKind::Smooth).locked};
  const LayerToEdit edited{of.layers, std::nullopt, of.weights, of.weights};
  const std::string name = of.armature->bones[static_cast<std::size_t>(bone)].name;
  start_task(context, kRepairing,
             [of, bone, settings, edited, name, tissue = parted_tissue(context)](Progress& progress) -> Finish {
               JointRepair repair = repair_joint({*of.volume, *tissue, *of.tissues, *of.armature}, *of.weights, bone,
                                                 settings, progress);
               auto told = std::make_shared<RepairedJoint>(RepairedJoint{.bone = name, .figures = {}, .in = {}});
               std::optional<EditedLayers> made;
               if (repair.is_better) made = on_own_layer(edited, "Joint of " + name, repair.weights);
               repair.weights = {};
               told->figures = std::move(repair);
               return [edited, name, told, made](Context& c) {
                 if (made) {
                   commit_weights(c, "Repair the joint of " + name, edited, *made);
                   choose_layer(c, made->layers->layers.size() - 1);
                   c.messages->ok(kRepairing, gain_of(told->figures));
                 } else {
                   c.messages->info(kRepairing, "No better weights were found: nothing was changed");
                 }
                 told->in = c.document().weights;
                 c.skin->painting->repaired_joint = told;
                 c.ui->touch();
               };
             });
}

bool repairs_joint(const Jobs& jobs) {
  const auto all = jobs.statuses();
  return std::any_of(all.begin(), all.end(),
                     [](const JobStatus& job) { return job.label == kRepairing && job.active(); });
}

}  // namespace limber::editor
