// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits the weights of the whole body or of a part of it. An edit respects locked bones, the clip plane and box, the
// brush's tissues and the region. It is one undo step, whose numbers can be adjusted afterwards (redo_last_operator.h).
// On a large body the work runs in a job, which commits its edit at the end unless the weights changed meanwhile.
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

// All inputs of a weight edit, copied so that it can run in a job.
struct WeightsToEdit {
  Document document;  // `document.weights`: with layers, those of the active layer
  std::shared_ptr<const TissueVoxels> tissue;
  StrokeSettings settings;  // as for a brush: the painted bones, locks, filter
  LayerToEdit layer;

  WeightedBody body() const { return {*document.volume, *tissue, *document.tissues, *document.armature}; }
};

WeightsToEdit weights_to_edit(Editor& editor);

struct EditedWeights {
  WeightEdit edit;
  std::string warning;                       // a warning for the user about a completed edit; "": none
  std::vector<std::int64_t> unmatched = {};  // indices of the tissue voxels that a mirror found no match for
};

// The tissues that an edit may change: those that the brush may paint, or all. AllTissues is for edits in which the
// user selects the tissue directly.
enum class EditReach { AsBrush, AllTissues };

struct WeightOperation {
  std::string label;  // name of the edit, "Flood Forearm"
  EditReach reach = EditReach::AsBrush;
  bool edits_bone_tissue = false;  // false: weights of bone tissue stay as they are
  bool reads_file = false;         // true: runs in a job even on a small body
  // Function that returns the voxels to edit; null: edit all voxels that `reach` allows.
  std::function<TissueRegion(const WeightsToEdit&)> where = {};
  std::function<EditedWeights(const WeightsToEdit&, const EditScope&)> work;
};
// Makes an operation from the field values of its form. Throws Error for values that cannot be applied.
using MakeWeightOperation = std::function<WeightOperation(const Editor&, const std::vector<FormField>&)>;

// Performs the operation, or starts a job for it; the user can adjust its fields afterwards. Cancels a weight edit that
// is still running.
void edit_weights(Editor& editor, const std::vector<FormField>& fields, const MakeWeightOperation& make);
// Returns a form's action that performs the operation. The form itself lets the user adjust the fields afterwards.
ActWith weight_act(const MakeWeightOperation& make);

// Returns the painted bone's name, or the number of painted bones: "Forearm" or "3 bones".
std::string painted_name(const Editor& editor);
// Returns the painted bones as indices into the weights' bones.
std::vector<int> painted_bones(const Editor& editor);

}  // namespace limber::editor
