// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits the weights of the whole body or a part of it. An edit changes neither locked bones nor any voxel that the clip
// plane, the clip box, the brush's tissues or the region exclude. An edit is one undo step, and the user can adjust its
// numbers afterwards (redo_last_operator.h). On a large body the edit is computed in a job. The job commits the edit at
// its end, unless the weights have changed meanwhile.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/paint/stroke.h"
#include "core/skin/weight_edits.h"
#include "editor/dialogs/redo_last_operator.h"
#include "editor/skin/weight_layers.h"

namespace limber::editor {

struct Context;

// All inputs of a weight edit, copied so that it can run in a job.
struct WeightsToEdit {
  Document document;  // copy of the document; if there are layers, its weights are those of the active layer
  std::shared_ptr<const TissueVoxels> tissue;
  StrokeSettings settings;  // bones to change, locked bones and voxel filter, as in a brush stroke
  LayerToEdit layer;

  WeightedBody body() const { return {*document.volume, *tissue, *document.tissues, *document.armature}; }
};

WeightsToEdit weights_to_edit(Context& context);

struct EditedWeights {
  WeightEdit edit;
  std::string warning;                       // a warning for the user about a completed edit; "": no warning
  std::vector<std::int64_t> unmatched = {};  // indices of the tissue voxels for which Mirror weights found no match
};

// The tissues that an edit may change: the tissues that the brush may paint, or all tissues. Edits in which the user
// selects the tissue directly use AllTissues.
enum class EditReach { AsBrush, AllTissues };

struct WeightOperation {
  std::string label;  // name of the edit, such as "Flood Forearm"
  EditReach reach = EditReach::AsBrush;
  bool edits_bone_tissue = false;  // false: the weights of voxels labelled as bone do not change
  bool reads_file = false;         // true: the operation reads a file, so it runs in a job even on a small body
  // Returns the voxels that the operation edits; null: it edits all voxels that `reach` allows.
  std::function<TissueRegion(const WeightsToEdit&)> where = {};
  std::function<EditedWeights(const WeightsToEdit&, const EditScope&)> work;
};
// Function that makes a weight operation from the values of its form's fields. Throws Error for values that the
// operation cannot use.
using MakeWeightOperation = std::function<WeightOperation(const Context&, const std::vector<FormField>&)>;

// Makes the operation from `fields` and performs it, in a job if the body is large. The user can adjust the fields
// afterwards. Cancels the job of an earlier weight edit that is still running.
void edit_weights(Context& context, const std::vector<FormField>& fields, const MakeWeightOperation& make);
// Returns the action of a form: performs the operation with the form's fields. Unlike edit_weights(), the action does
// not let the user adjust the fields afterwards, because the form does this itself.
ActWith weight_act(const MakeWeightOperation& make);

// Returns a text for the bones that brushes paint now: the name of a single bone ("Forearm"), else their number
// ("3 bones").
std::string painted_name(const Context& context);
// Returns the bones that brushes paint now, as indices into the bones of the document's weights.
std::vector<int> painted_bones(const Context& context);

}  // namespace limber::editor
