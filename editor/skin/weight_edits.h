// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the weights of the whole body or of a part of it, as the user asks for them: under the locks and within the
// clip, the chosen tissues and the region of the document of the moment; each is one edit, whose numbers can be changed
// afterwards (redo_last_operator.h). On a large body the work is a job: its edit comes when it is done, unless the
// weights were changed meanwhile.
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

// All that the work reads, so that it can go on beside the editor.
struct WeightsToEdit {
  Document document;  // its weights are what is edited: those of the active layer, where there are any
  std::shared_ptr<const TissueVoxels> tissue;
  StrokeSettings settings;  // as of a brush: the painted bones, locks, filter
  LayerToEdit layer;

  WeightedBody body() const { return {*document.volume, *tissue, *document.tissues, *document.armature}; }
};

WeightsToEdit weights_to_edit(Editor& editor);

struct EditedWeights {
  WeightEdit edit;
  std::string warning;                       // what the user should know of a work that was done; "" for nothing
  std::vector<std::int64_t> unmatched = {};  // places that a mirror found nothing for
};

// How far an edit reaches: as the brush may, or in all tissues (what is named by itself need not be among the brush's).
enum class EditReach { AsBrush, AllTissues };

struct WeightOperation {
  std::string label;  // of the edit: "Flood Forearm"
  EditReach reach = EditReach::AsBrush;
  bool edits_bone_tissue = false;  // else it stays as it is
  bool reads_file = false;         // so it is a job whatever the body
  // Where: empty for all that the reach allows.
  std::function<TissueRegion(const WeightsToEdit&)> where = {};
  std::function<EditedWeights(const WeightsToEdit&, const EditScope&)> work;
};
// Throws Error for what cannot be done.
using MakeWeightOperation = std::function<WeightOperation(const Editor&, const std::vector<FormField>&)>;

// Does it, or begins to; its fields can be adjusted afterwards. An edit of weights that is still at work is cancelled.
void edit_weights(Editor& editor, const std::vector<FormField>& fields, const MakeWeightOperation& make);
// For a form, which makes its act adjustable itself.
ActWith weight_act(const MakeWeightOperation& make);

// "Forearm", or "3 bones": what is painted.
std::string painted_name(const Editor& editor);
// The bones of the weights that are painted.
std::vector<int> painted_bones(const Editor& editor);

}  // namespace limber::editor
