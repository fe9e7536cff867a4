// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of how tissues are shown, and of what they are: one commit each.
#pragma once

#include <set>

#include "editor/context/editor.h"

namespace limber::editor {

// As lists show it: "muscle" begins with a capital, one without a name is "Label 17".
std::string shown_name(const Tissue& tissue);
std::string capitalized(std::string name);  // "fat" -> "Fat"

TissueLook look_of(const Document& document, Label label);
void set_look(Editor& editor, const std::string& label, Label tissue, const TissueLook& look);
// The same, shown but not yet an edit; set_look() or Escape ends it.
void preview_look(Editor& editor, Label tissue, const TissueLook& look);
void preview_tissue(Editor& editor, const Tissue& tissue);
void show_tissues(Editor& editor, const std::set<Label>& tissues, bool visible);
void solo_tissues(Editor& editor, const std::set<Label>& tissues);  // a second time: shows all again
void reveal_tissues(Editor& editor);
// Replaces the entry of that label. `what` names the edit: "Colour of Muscle".
void set_tissue(Editor& editor, const std::string& what, const Tissue& tissue);

void rename_tissue(Editor& editor, Label label, const std::string& name);

// Chooses a tissue; extended, it is added to the chosen ones or taken out.
void select_tissue(Editor& editor, Label label, bool extended);

}  // namespace limber::editor
