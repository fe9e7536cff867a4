// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/labels/label_edits.h"

#include <algorithm>
#include <set>

#include "core/base/error.h"
#include "editor/context/arriving_body.h"
#include "editor/context/background_task.h"
#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/seams/seam_view.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"
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

std::string needs_edited_tissue(const Context& context) {
  const Document& document = context.document();
  if (!document.volume || !document.tissues) return "Open a volume first";
  return context.selection->tissue && document.tissues->find(*context.selection->tissue)
             ? ""
             : "Select a tissue first, under Label brush or Tissues in the sidebar";
}

const Tissue& edited_tissue(const Context& context) {
  return *context.document().tissues->find(*context.selection->tissue);
}

void commit_labels(Context& context, const std::string& label, std::shared_ptr<const LabelVolume> after,
                   const LabelChange& change, std::shared_ptr<const TissueTable> tissues) {
  note_weights_source(context);
  std::string removed;
  commit(context, label, with_labels(context.document(), after, keeps_tissue_voxels(change), tissues, removed));
  if (!removed.empty()) context.messages->warn(label, removed + ". Undo brings them back");
}

void start_label_edit(Context& context, LabelEdit edit) {
  note_weights_source(context);
  const auto before = context.document().volume;
  const auto tissues = context.document().tissues;
  const auto table = edit.tissues ? edit.tissues : context.document().tissues;
  const std::string label = edit.label;
  struct Outcome {
    std::string note, removed;
    bool changed = false;
  };
  const auto outcome = std::make_shared<Outcome>();
  const int id =
      context.jobs->start(label,
                          [before, tissues, table, edit, outcome, visibility = context.document().visibility,
                           make_ready = body_maker(*context.views)](Progress& progress) -> Edit {
                            progress.update("labels", 0);
                            const FoundLabelEdit found = edit.find(*before, progress);
                            outcome->note = found.note;
                            outcome->changed = !found.change.empty();
                            if (!outcome->changed) return [](const Document& now) { return now; };
                            auto changed = std::make_shared<LabelVolume>(*before);
                            apply_change(found.change, *changed);
                            const std::shared_ptr<const LabelVolume> after = std::move(changed);
                            make_ready({.volume = after, .tissues = table, .visibility = visibility}, progress, {});
                            return [before, after, tissues, wanted = edit.tissues,
                                    same = keeps_tissue_voxels(found.change), outcome](const Document& now) {
                              if (now.volume != before)
                                throw Error("the labels were changed meanwhile", "the edit", "repeat the edit");
                              if (wanted && now.tissues != tissues)
                                throw Error("the list of tissues was changed meanwhile", "the edit", "repeat the edit");
                              return with_labels(now, after, same, wanted, outcome->removed);
                            };
                          });
  context.background->step_of_job[id] = StepOfWork::Prepare;
  context.background->after_job[id] = [label, outcome, select = edit.select](Context& c, const JobStatus& job) {
    if (job.state != JobState::Done) return;
    if (outcome->changed && select) select_tissue(c, *select, false);
    if (!outcome->removed.empty()) c.messages->warn(label, outcome->removed + ". Undo brings them back");
    else outcome->changed ? c.messages->ok(label, outcome->note) : c.messages->info(label, outcome->note);
  };
  context.ui->touch();
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
