// SPDX-License-Identifier: AGPL-3.0-or-later
// A dialog with a few fields and one action that uses their values. Enter runs the action, Escape closes the dialog.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "editor/dialogs/form_field.h"

namespace limber::editor {

class Dialog;
struct Context;
struct Rect;

// Thrown by FormRequest::outcome while the user still has to fill in fields. The form shows `words`, which tell the
// user what to fill in, as a plain text and not as an error.
struct NotYet {
  std::string words;
};

// What a field does with a typed number outside its range. Clamped: the field replaces it by the nearest limit. Stays:
// the field keeps the number, and the form's button is disabled until the user corrects it.
enum class OutOfRange { Clamped, Stays };

// Draws a row that has a label at the left and the field at the right. Returns true in the frame in which the user has
// changed the field's value. For a number, this is the frame in which the drag or the typing ends.
//   focus  true: gives the field the keyboard
bool draw_field(Context& context, FormField& field, const Rect& row, float label_width, bool focus = false,
                OutOfRange numbers = OutOfRange::Clamped);

// The contents of a form. A number outside its range disables the form's primary button, and a line under the field
// says why. The first text or number field gets the keyboard.
struct FormRequest {
  std::string title;
  std::string description;  // what the form does; shown above the fields
  std::string action;       // the label of the primary button
  std::vector<FormField> fields;
  // Returns a text for the line below the fields that tells what the action will do with them. Throws Error if the
  // action is impossible: the form then shows the error's text and disables the primary button. Throws NotYet to
  // disable the button without showing an error.
  std::function<std::string(const Context&, const std::vector<FormField>&)> outcome;
  std::function<void(Context&, const std::vector<FormField>&)> act;
  // Draws a picture at the right of the fields that illustrates what they mean; an empty function: no picture.
  std::function<void(Context&, const Rect&, const std::vector<FormField>&)> picture;
};
std::unique_ptr<Dialog> make_form(FormRequest request);

}  // namespace limber::editor
