// SPDX-License-Identifier: AGPL-3.0-or-later
// Lets the user change the numbers of the last operation afterwards, as Blender's redo panel does. Each change undoes
// the operation and does it again with the new numbers, so that the history keeps one step. Forms and transforms run
// their operations by act_and_allow_redo(), which allows this.
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
  std::string label;  // the history's label of its edit; "": there is nothing to redo
  std::vector<FormField> fields;
  std::vector<FormField> shown = fields;  // the fields as displayed, which differ from `fields` while the user drags
  ActWith act;
  // The history's revision after the operation. The operation can be redone only while this is the current revision.
  std::int64_t revision = -1;
  bool made_a_step = true;  // false: the operation changed nothing, so there is no step to undo

  Selection selection;  // the selection before the operation, restored before it is redone
  TransformSettings::Part part = TransformSettings::Part::Whole;

  bool unfolded = false;  // whether the operation's panel in the view is unfolded
  bool wanted_at_pointer = false;
};

// Calls act(editor, fields). If that adds exactly one step to the history, the user may redo it with other fields.
//   first  is called this time in place of `act`, if not empty; later calls use `act`
void act_and_allow_redo(Editor& editor, const std::vector<FormField>& fields, const ActWith& act,
                        const std::function<void(Editor&)>& first = {});

// Returns why the last operation cannot be adjusted now; "" when it can.
std::string why_not_redo(const Editor& editor);
// Undoes the last operation and does it again with other fields. If it throws, the error is shown as a message and the
// document stays as it was.
void redo_last_operator(Editor& editor, const std::vector<FormField>& fields);

// Draws the panel with the last operation's fields at the lower left of a view.
void draw_last_operation(Editor& editor, const Rect& view);
// Draws the panel with the last operation's fields as a popup, which opens at the pointer when
// LastOperation::wanted_at_pointer is set.
void draw_last_operation_popup(Editor& editor);

}  // namespace limber::editor
