// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the document's labels. Each edit is one step of the history. Weights are kept only if the same voxels stay
// tissue; with other voxels they do not fit any more, so they are removed and a message says so, as with all changes of
// the volume (editor/volume/volume_edits.h). Undo brings them back.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "core/label_edit/label_change.h"
#include "editor/context/editor.h"

namespace limber::editor {

// Returns why no tissue's labels can be edited; "" if the active tissue's can.
std::string needs_edited_tissue(const Editor& editor);
// Returns the active tissue, which label edits change. needs_edited_tissue() must be "".
const Tissue& edited_tissue(const Editor& editor);

// Replaces the document's labels as one edit.
//   change   what differs between the document's volume and `after`
//   tissues  the new tissue table; null: the table stays
void commit_labels(Editor& editor, const std::string& label, std::shared_ptr<const LabelVolume> after,
                   const LabelChange& change, std::shared_ptr<const TissueTable> tissues = nullptr);

// What a job finds out about an edit of labels.
struct FoundLabelEdit {
  LabelChange change;
  std::string note;  // what was done, for the user: "2 islands removed"
};
struct LabelEdit {
  std::string label;  // the name of the job and of the edit: "Fill holes of bone"
  std::function<FoundLabelEdit(const LabelVolume& volume, Progress& progress)> find;
  std::shared_ptr<const TissueTable> tissues;  // the new tissue table; null: the table stays
  std::optional<Label> select;                 // the tissue that is selected when the edit is done
};
// Starts a job that edits the labels. The document must have a volume.
void start_label_edit(Editor& editor, LabelEdit edit);

// Returns a new tissue with a label and a file value that the table does not use, and with its own colour. It has the
// properties of `like`, and its name with a number behind it; with null it is unknown tissue.
Tissue new_tissue_like(const TissueTable& tissues, const Tissue* like);
// Returns the table with one more tissue.
std::shared_ptr<const TissueTable> with_tissue(const TissueTable& tissues, const Tissue& tissue);

}  // namespace limber::editor
