// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the document's labels. Each edit is one step of the history. If an edit changes which voxels are tissue,
// the weights do not fit the volume any more: they are removed and a message says so (editor/volume/volume_edits.h).
// Undo restores them.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/label_edit/label_change.h"
#include "core/tissue/tissue_table.h"

namespace limber::editor {

struct Context;

// Returns why no tissue's labels can be edited now; "" if the labels of the active tissue can be edited.
std::string needs_edited_tissue(const Context& context);
// Returns the active tissue, whose labels are edited. Call it only if needs_edited_tissue() returns "".
const Tissue& edited_tissue(const Context& context);

// Replaces the document's labels as one edit.
//   change   the differences between the document's volume and `after`
//   tissues  the new tissue table; null: the table does not change
void commit_labels(Context& context, const std::string& label, std::shared_ptr<const LabelVolume> after,
                   const LabelChange& change, std::shared_ptr<const TissueTable> tissues = nullptr);

// The result of a job that edits labels.
struct FoundLabelEdit {
  LabelChange change;
  std::string note;  // message for the user about what was done: "2 islands removed"
};
struct LabelEdit {
  std::string label;  // name of the job and of the edit: "Fill holes of bone"
  std::function<FoundLabelEdit(const LabelVolume& volume, Progress& progress)> find;
  std::shared_ptr<const TissueTable> tissues;  // the new tissue table; null: the table does not change
  std::optional<Label> select;                 // the tissue that is selected when the edit is done
};
// Starts a job that edits the labels. The document must have a volume.
void start_label_edit(Context& context, LabelEdit edit);

// Returns a new tissue with a label and a file value that the table does not use yet, and with a colour of its own. It
// has the other properties of `like` and the name of `like` with a number appended. If `like` is null, its kind is
// unknown.
Tissue new_tissue_like(const TissueTable& tissues, const Tissue* like);
// Returns a copy of the table with the tissue appended.
std::shared_ptr<const TissueTable> with_tissue(const TissueTable& tissues, const Tissue& tissue);

}  // namespace limber::editor
