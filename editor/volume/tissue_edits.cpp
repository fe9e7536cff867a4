// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/tissue_edits.h"

#include <algorithm>

#include "editor/context/context.h"
#include "editor/context/document_edits.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

std::string name_of(const Context& context, const std::set<Label>& tissues) {
  if (tissues.size() != 1) return std::to_string(tissues.size()) + " tissues";
  const Tissue* tissue = context.document().tissues ? context.document().tissues->find(*tissues.begin()) : nullptr;
  return tissue ? shown_name(*tissue) : "label " + std::to_string(*tissues.begin());
}

void commit_looks(Context& context, const std::string& label,
                  const std::function<void(std::map<Label, TissueLook>&)>& change) {
  Visibility visibility = context.document().visibility ? *context.document().visibility : Visibility{};
  const Visibility before = visibility;
  change(visibility.looks);
  if (visibility == before) return;
  Document next = context.document();
  next.visibility = std::make_shared<const Visibility>(std::move(visibility));
  commit(context, label, std::move(next));
}

}  // namespace

std::string shown_name(const Tissue& tissue) {
  std::string name = capitalized(tissue.name.empty() ? "Label " + std::to_string(tissue.label) : tissue.name);
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string capitalized(std::string name) {
  if (!name.empty() && name[0] >= 'a' && name[0] <= 'z') name[0] = static_cast<char>(name[0] - 'a' + 'A');
  return name;
}

TissueLook look_of(const Document& document, Label label) {
  if (!document.visibility) return {};
  const auto found = document.visibility->looks.find(label);
  return found == document.visibility->looks.end() ? TissueLook{} : found->second;
}

void set_look(Context& context, const std::string& label, Label tissue, const TissueLook& look) {
  context.views->preview_visibility.reset();
  commit_looks(context, label, [&](auto& looks) { looks[tissue] = look; });
}

void preview_look(Context& context, Label tissue, const TissueLook& look) {
  Visibility visibility = context.document().visibility ? *context.document().visibility : Visibility{};
  visibility.looks[tissue] = look;
  context.views->preview_visibility = std::make_shared<const Visibility>(std::move(visibility));
  context.ui->touch();
}

void preview_tissue(Context& context, const Tissue& tissue) {
  TissueTable table = *context.document().tissues;
  if (Tissue* place = table.find(tissue.label)) *place = tissue;
  context.views->preview_tissues = std::make_shared<const TissueTable>(std::move(table));
  context.ui->touch();
}

void show_tissues(Context& context, const std::set<Label>& tissues, bool visible) {
  commit_looks(context, (visible ? "Show " : "Hide ") + name_of(context, tissues), [&](auto& looks) {
    for (const Label label : tissues) looks[label].visible = visible;
  });
}

void solo_tissues(Context& context, const std::set<Label>& tissues) {
  bool alone = true;
  for (const Tissue& tissue : context.document().tissues->tissues)
    if (look_of(context.document(), tissue.label).visible != tissues.contains(tissue.label)) alone = false;
  if (alone) return reveal_tissues(context);
  commit_looks(context, "Show only " + name_of(context, tissues), [&](auto& looks) {
    for (const Tissue& tissue : context.document().tissues->tissues)
      looks[tissue.label].visible = tissues.contains(tissue.label);
  });
}

void reveal_tissues(Context& context) {
  commit_looks(context, "Reveal all", [](auto& looks) {
    for (auto& [label, look] : looks) look.visible = true;
  });
}

void set_tissue(Context& context, const std::string& what, const Tissue& tissue) {
  context.views->preview_tissues.reset();
  TissueTable table = *context.document().tissues;
  Tissue* place = table.find(tissue.label);
  if (!place) return;
  *place = tissue;
  Document next = context.document();
  next.tissues = std::make_shared<const TissueTable>(std::move(table));
  commit(context, what, std::move(next));
}

void set_kind(Context& context, Label label, TissueKind kind) {
  Tissue tissue = *context.document().tissues->find(label);
  if (tissue.kind == kind) return;
  Tissue before = tissue, after = tissue;
  after.kind = kind;
  apply_kind_defaults(before);
  apply_kind_defaults(after);
  tissue.kind = kind;
  tissue.priority = after.priority;
  for (double Tissue::*number : {&Tissue::density, &Tissue::young_modulus, &Tissue::poisson_ratio})
    if (tissue.*number == before.*number) tissue.*number = after.*number;
  set_tissue(context, "Set kind of " + shown_name(tissue), tissue);
}

void rename_tissue(Context& context, Label label, const std::string& name) {
  Tissue tissue = *context.document().tissues->find(label);
  if (name.empty() || name == tissue.name) return;
  const std::string before = shown_name(tissue);
  tissue.name = name;
  set_tissue(context, "Rename " + before, tissue);
}

void select_tissue(Context& context, Label label, bool extended) {
  Selection& selection = context.selection;
  if (!extended) {
    selection.tissues = {label};
    selection.tissue = label;
    return;
  }
  if (selection.tissues.erase(label) == 0) {
    selection.tissues.insert(label);
    selection.tissue = label;
  } else if (selection.tissue == label) {
    selection.tissue.reset();
    if (!selection.tissues.empty()) selection.tissue = *selection.tissues.begin();
  }
}

}  // namespace limber::editor
