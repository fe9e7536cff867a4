// SPDX-License-Identifier: AGPL-3.0-or-later
// Lets the user change the numbers of the last operation afterwards, as Blender's redo panel does. Each change undoes
// the operation and performs it again with the new numbers, so that the history keeps one step. This works for
// operations that were started by act_and_allow_redo(), such as those of forms and transforms.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "editor/context/selection.h"
#include "editor/context/transform_settings.h"
#include "editor/dialogs/form_field.h"

namespace limber::editor {

struct Context;
struct Rect;

using ActWith = std::function<void(Context&, const std::vector<FormField>&)>;

struct LastOperation {
  std::string label;  // label of the operation's step in the undo history; "": no operation can be redone
  std::vector<FormField> fields;
  std::vector<FormField> shown = fields;  // the displayed fields; they differ from `fields` while the user drags one
  ActWith act;
  // Revision number of the history after the operation. The operation can be changed only while the history still has
  // this revision.
  std::int64_t revision = -1;
  bool made_a_step = true;  // false: the operation changed nothing, so there is no step to undo

  Selection selection;  // selection before the operation; it is restored before the operation is performed again
  TransformSettings::Part part = TransformSettings::Part::Whole;

  bool unfolded = false;  // true: the panel with the operation's fields, which is drawn in the view, is open
  bool wanted_at_pointer = false;
};

// Performs an operation by act(context, fields). If the call adds exactly one step to the history, the user may change
// the fields afterwards, which undoes the step and calls `act` again.
//   first  called in place of `act` the first time; empty: `act` is called
void act_and_allow_redo(Context& context, const std::vector<FormField>& fields, const ActWith& act,
                        const std::function<void(Context&)>& first = {});

// Returns why the user cannot change the fields of the last operation now; "" when it is possible.
std::string why_not_redo(const Context& context);
// Undoes the last operation and performs it again with other fields. If the operation throws an error, shows the error
// as a message and restores the document.
void redo_last_operator(Context& context, const std::vector<FormField>& fields);

// Draws the panel with the last operation's fields at the lower left corner of a view.
void draw_last_operation(Context& context, const Rect& view);
// Draws the panel with the last operation's fields as a popup, which opens at the pointer when
// LastOperation::wanted_at_pointer is set.
void draw_last_operation_popup(Context& context);

}  // namespace limber::editor
