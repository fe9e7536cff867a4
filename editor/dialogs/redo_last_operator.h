// SPDX-License-Identifier: AGPL-3.0-or-later
// The operation that was done last, done again with other numbers, as Blender's redo panel does: each change takes its
// step back and does it anew, so that it stays one step of the history. What acts once and can act again with other
// values hands itself over here: forms and transforms all do.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "editor/context/transform_settings.h"
#include "editor/dialogs/form_dialog.h"

namespace limber::editor {

using ActWith = std::function<void(Editor&, const std::vector<FormField>&)>;

struct LastOperation {
  std::string label;  // of its edit; "" for none
  std::vector<FormField> fields;
  std::vector<FormField> shown = fields;  // while one of them is dragged
  ActWith act;
  std::int64_t revision = -1;  // of the document that it left
  bool made_a_step = true;     // not where its numbers come to nothing

  Selection selection;  // before it
  TransformSettings::Part part = TransformSettings::Part::Whole;

  bool unfolded = false;  // its box in the view
  bool wanted_at_pointer = false;
};

// Acts, and may do so again where that made one step.
//   first  what it does this time, where that is not the act with these fields
void act_and_allow_redo(Editor& editor, const std::vector<FormField>& fields, const ActWith& act,
                        const std::function<void(Editor&)>& first = {});

// Why there is nothing to adjust now; "" where there is.
std::string why_not_redo(const Editor& editor);
// What is thrown becomes a message, and all stays as it was.
void redo_last_operator(Editor& editor, const std::vector<FormField>& fields);

// At the lower left of a view.
void draw_last_operation(Editor& editor, const Rect& view);
// At the pointer, once wanted.
void draw_last_operation_popup(Editor& editor);

}  // namespace limber::editor
