// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/labels/label_edits.h"

#include <algorithm>
#include <set>

#include "core/base/error.h"
#include "editor/context/document_edits.h"
#include "editor/seams/seam_view.h"
#include "editor/volume/tissue_edits.h"
#include "editor/volume/volume_edits.h"

namespace limber::editor {

namespace {

Document with_labels(const Document& now, const std::shared_ptr<const LabelVolume>& after, bool same_tissue,
                     const std::shared_ptr<const TissueTable>& tissues, std::string& removed) {
  Document next = with_volume(now, after, same_tissue, false, removed);
  if (tissues) next.tissues = tissues;
  return next;
}

}  // namespace

std::string needs_edited_tissue(const Editor& editor) {
  const Document& document = editor.document();
  if (!document.volume || !document.tissues) return "Open a volume first";
  return editor.selection.tissue && document.tissues->find(*editor.selection.tissue)
             ? ""
             : "Select a tissue in the list of tissues first";
}

const Tissue& edited_tissue(const Editor& editor) { return *editor.document().tissues->find(*editor.selection.tissue); }

void commit_labels(Editor& editor, const std::string& label, std::shared_ptr<const LabelVolume> after,
                   const LabelChange& change, std::shared_ptr<const TissueTable> tissues) {
  note_weights_source(editor);
  std::string removed;
  commit(editor, label, with_labels(editor.document(), after, keeps_tissue_voxels(change), tissues, removed));
  if (!removed.empty()) editor.messages.warn(label, removed + ". Undo brings them back");
}

void start_label_edit(Editor& editor, LabelEdit edit) {
  note_weights_source(editor);
  const auto before = editor.document().volume;
  const auto tissues = editor.document().tissues;
  const auto table = edit.tissues ? edit.tissues : editor.document().tissues;
  const std::string label = edit.label;
  struct Outcome {
    std::string note, removed;
    bool changed = false;
  };
  const auto outcome = std::make_shared<Outcome>();
  const int id =
      editor.jobs.start(label,
                        [before, tissues, table, edit, outcome, visibility = editor.document().visibility,
                         make_ready = body_maker(*editor.views)](Progress& progress) -> Edit {
                          progress.update("labels", 0);
                          const FoundLabelEdit found = edit.find(*before, progress);
                          outcome->note = found.note;
                          outcome->changed = !found.change.empty();
                          if (!outcome->changed) return [](const Document& now) { return now; };
                          auto changed = std::make_shared<LabelVolume>(*before);
                          apply_change(found.change, *changed);
                          const std::shared_ptr<const LabelVolume> after = std::move(changed);
                          make_ready({.volume = after, .tissues = table, .visibility = visibility}, progress);
                          return [before, after, tissues, wanted = edit.tissues,
                                  same = keeps_tissue_voxels(found.change), outcome](const Document& now) {
                            if (now.volume != before)
                              throw Error("the labels were changed meanwhile", "the edit", "start it again");
                            if (wanted && now.tissues != tissues)
                              throw Error("the list of tissues was changed meanwhile", "the edit", "start it again");
                            return with_labels(now, after, same, wanted, outcome->removed);
                          };
                        });
  editor.step_of_job[id] = StepOfWork::Prepare;
  editor.after_job[id] = [label, outcome, select = edit.select](Editor& e, const JobStatus& job) {
    if (job.state != JobState::Done) return;
    if (outcome->changed && select) select_tissue(e, *select, false);
    if (!outcome->removed.empty()) e.messages.warn(label, outcome->removed + ". Undo brings them back");
    else outcome->changed ? e.messages.ok(label, outcome->note) : e.messages.info(label, outcome->note);
  };
  editor.touch();
}

Tissue new_tissue_like(const TissueTable& tissues, const Tissue* like) {
  std::set<Label> labels;
  std::set<double> values;
  std::set<std::string> names;
  for (const Tissue& tissue : tissues.tissues) {
    labels.insert(tissue.label);
    values.insert(tissue.file_value);
    names.insert(tissue.name);
  }
  Label label = 1;
  while (labels.contains(label) || values.contains(label)) {
    if (label == 65535) throw Error("there is no free label", "the list of tissues", "merge some tissues first");
    ++label;
  }
  Tissue own;  // a tissue whose default colour is computed from its label
  own.label = label;
  own.file_value = label;
  apply_kind_defaults(own);
  Tissue tissue = like ? *like : own;
  tissue.label = label;
  tissue.file_value = label;
  tissue.colour = own.colour;
  const std::string name = like ? like->name : "New tissue";
  tissue.name = name;
  for (int number = 2; names.contains(tissue.name); ++number) tissue.name = name + " " + std::to_string(number);
  return tissue;
}

std::shared_ptr<const TissueTable> with_tissue(const TissueTable& tissues, const Tissue& tissue) {
  auto table = std::make_shared<TissueTable>(tissues);
  const auto place = std::lower_bound(table->tissues.begin(), table->tissues.end(), tissue.label,
                                      [](const Tissue& t, Label label) { return t.label < label; });
  table->tissues.insert(place, tissue);
  return table;
}

}  // namespace limber::editor
