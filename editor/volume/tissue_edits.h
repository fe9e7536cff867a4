// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of how tissues are shown, and of the tissue table's entries. Each edit is one step of the history.
#pragma once

#include <set>

#include "core/project/document.h"

namespace limber::editor {

struct Context;

// Returns a tissue's name as lists show it: with a capital letter and without "_", or "Label 17" if it has no name.
std::string shown_name(const Tissue& tissue);
std::string capitalized(std::string name);  // returns the name with a capital first letter: "fat" -> "Fat"

TissueLook look_of(const Document& document, Label label);
void set_look(Context& context, const std::string& label, Label tissue, const TissueLook& look);
// Show a change of a tissue in the views without changing the document. The preview ends when set_look() or
// set_tissue() puts the change into the document, or when the user presses Escape.
void preview_look(Context& context, Label tissue, const TissueLook& look);
void preview_tissue(Context& context, const Tissue& tissue);
void show_tissues(Context& context, const std::set<Label>& tissues, bool visible);
// Shows only these tissues and hides all others. If all others are hidden already, shows all tissues.
void solo_tissues(Context& context, const std::set<Label>& tissues);
void reveal_tissues(Context& context);
// Replaces the entry of the tissue table that has the same label as `tissue`, as one edit. `what` is the name of the
// edit, such as "Colour of Muscle".
void set_tissue(Context& context, const std::string& what, const Tissue& tissue);

// Sets the kind of a tissue. The kind decides whether the tissue moves rigidly, and which tissue a voxel gets if
// several overlap. Material properties that had the default values of the old kind get those of the new kind. Other
// properties and the colour do not change.
void set_kind(Context& context, Label label, TissueKind kind);

void rename_tissue(Context& context, Label label, const std::string& name);

// Selects only this tissue. If `extended`, adds the tissue to the selection instead, or removes it if it is selected.
void select_tissue(Context& context, Label label, bool extended);

}  // namespace limber::editor
