// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/skin/weight_edits.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/seams/seam_view.h"
#include "editor/ui/messages.h"

#include <algorithm>
#include <optional>

#include "editor/context/document_edits.h"
#include "editor/skin/brush_settings.h"
#include "editor/skin/weight_display.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

using Fields = std::vector<FormField>;

// Returns the voxels that the operation may change: the voxels that both the brush's filters and operation.where allow.
// An empty result stands for all voxels.
TissueRegion region_of(const WeightsToEdit& what, const WeightOperation& operation) {
  TissueRegion own;
  if (operation.where) own = operation.where(what);
  const BrushFilter& filter = what.settings.filter;
  const bool by_label = operation.reach == EditReach::AsBrush && !filter.labels.empty();
  if (!by_label && !filter.box && !filter.plane && !filter.allows) return own;
  const LabelVolume& volume = *what.document.volume;
  const AffineTransform world = world_from_voxel(volume.grid);
  return region_where(*what.tissue, [&](std::int64_t place, const glm::ivec3& voxel) {
    if (!own.empty() && !own[static_cast<std::size_t>(place)]) return false;
    if (by_label && !filter.labels[volume.at(voxel)]) return false;
    if (filter.box && !(glm::all(glm::greaterThanEqual(glm::dvec3(voxel), filter.box->low)) &&
                        glm::all(glm::lessThanEqual(glm::dvec3(voxel), filter.box->high))))
      return false;
    if (filter.plane && glm::dot(world * glm::dvec3(voxel) - filter.plane->point, filter.plane->normal) > 0)
      return false;
    return !filter.allows || filter.allows(place, voxel);
  });
}

struct Done {
  EditedWeights edited;
  std::optional<EditedLayers> made;  // the document's layers after the edit; no value: the edit changed nothing
};

Done done(const WeightsToEdit& what, const WeightOperation& operation, Progress& progress) {
  progress.update("where", 0);
  EditScope scope;
  scope.locked = what.settings.locked;
  scope.normalize = what.settings.normalize;
  scope.rigid_bone_tissue = !operation.edits_bone_tissue;
  scope.region = region_of(what, operation);
  scope.progress = &progress;
  Done result{operation.work(what, scope), {}};
  if (result.edited.edit.changed > 0)
    result.made = edited_layers(what.layer, std::make_shared<const SkinWeights>(result.edited.edit.weights));
  return result;
}

// Commits the result of the operation, or tells the user why there is nothing to commit. Returns true if the result was
// committed.
bool keep(Context& context, const WeightsToEdit& what, const WeightOperation& operation, Done result) {
  EditedWeights& outcome = result.edited;
  const WeightEdit& edit = outcome.edit;
  const Document& now = context.document();
  const bool others = now.layers != what.layer.layers || now.weights != what.layer.came_out;
  if (others || now.volume != what.document.volume || now.armature != what.document.armature) {
    context.messages->warn(operation.label,
                           "The weights were changed meanwhile, so nothing was applied: run the command again");
    return false;
  }
  const std::string lock = edit.blocked > 0 && edit.blocked_by >= 0 ? lock_message(*now.armature, edit.blocked_by) : "";
  context.skin->painting->unmatched = std::move(outcome.unmatched);
  if (edit.changed == 0) {
    if (!lock.empty())
      context.messages->toast_error(lock, "No other unlocked bone can give or take weight here", "skin.unlock_all");
    else if (!outcome.warning.empty()) context.messages->warn(operation.label, outcome.warning);
    else context.messages->info(operation.label, "No weight needed to change");
    return false;
  }
  commit_weights(context, operation.label, what.layer, *result.made);
  const bool was_off = what.settings.normalize == Normalize::WhenComposed;
  const std::string changed = grouped(edit.changed) + (edit.changed == 1 ? " voxel" : " voxels") +
                              (was_off ? ", normalized: switching Normalize off affects only brush strokes" : "");
  if (!outcome.warning.empty()) context.messages->warn(operation.label, outcome.warning);
  else if (!lock.empty())
    context.messages->warn(operation.label, changed + "; " + grouped(edit.blocked) + " unchanged: " + lock);
  else context.messages->ok(operation.label, changed);
  return true;
}

void perform(Context& context, const Fields& fields, const MakeWeightOperation& make) {
  Painting& painting = *context.skin->painting;
  if (painting.edit_job) context.jobs->cancel(*painting.edit_job);
  painting.edit_job.reset();
  const WeightOperation operation = make(context, fields);
  const WeightsToEdit what = weights_to_edit(context);
  if (what.tissue->size() <= painting.edited_at_once && !operation.reads_file) {
    keep(context, what, operation, done(what, operation, no_progress()));
    return;
  }
  const Selection selection = context.selection;
  painting.edit_job = start_task(context, operation.label, [=](Progress& progress) -> Finish {
    auto outcome = std::make_shared<Done>(done(what, operation, progress));
    return [=](Context& c) {
      c.skin->painting->edit_job.reset();
      if (!keep(c, what, operation, std::move(*outcome)) || fields.empty()) return;
      *c.last_operation = {.label = operation.label,
                           .fields = fields,
                           .shown = fields,
                           .act = weight_act(make),
                           .revision = c.history->revision(),
                           .selection = selection,
                           .part = c.transform_settings->part,
                           .unfolded = c.last_operation->unfolded};
    };
  });
}

}  // namespace

WeightsToEdit weights_to_edit(Context& context) {
  WeightsToEdit what{context.document(), parted_tissue(context), stroke_settings(context, BrushKind::Set),
                     layer_to_edit(context)};
  what.document.weights = what.layer.weights;
  return what;
}

ActWith weight_act(const MakeWeightOperation& make) {
  return [make](Context& context, const Fields& fields) { perform(context, fields, make); };
}

void edit_weights(Context& context, const Fields& fields, const MakeWeightOperation& make) {
  act_and_allow_redo(context, fields, weight_act(make));
}

std::vector<int> painted_bones(const Context& context) { return stroke_settings(context, BrushKind::Set).bones; }

std::string painted_name(const Context& context) {
  const std::vector<int> bones = painted_bones(context);
  return bones.size() == 1 ? context.document().weights->bones()[static_cast<std::size_t>(bones[0])]
                           : std::to_string(bones.size()) + " bones";
}

}  // namespace limber::editor
