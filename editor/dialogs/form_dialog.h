// SPDX-License-Identifier: AGPL-3.0-or-later
// A dialog with a few fields and one action that uses their values. Enter runs the action, Escape closes the dialog.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

struct FormField {
  std::string label;
  std::string description;  // the field's tool tip

  enum class Kind { Number, Choice, Text, Fact } kind = Kind::Number;
  double value = 0, low = 0, high = 1;  // of a Number field: its value and its range [low, high]
  const char* format = "%.0f";
  const char* unit = "";
  // Choices of a Choice field: up to four are shown as buttons in a row, more as a list.
  std::vector<std::string> choices;
  int chosen = 0;
  std::string text;  // text of a Text field (the user edits it) or of a Fact field (only shown)
};
FormField number_of(std::string label, std::string description, double value, double low, double high,
                    const char* format, const char* unit = "");
FormField choice_of(std::string label, std::string description, std::vector<std::string> choices, int chosen = 0);

FormField text_of(std::string label, std::string description, std::string text);
FormField fact_of(std::string label, std::string text);

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
bool draw_field(Editor& editor, FormField& field, const Rect& row, float label_width, bool focus = false,
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
  std::function<std::string(const Editor&, const std::vector<FormField>&)> outcome;
  std::function<void(Editor&, const std::vector<FormField>&)> act;
  // Draws a picture at the right of the fields that illustrates what they mean; an empty function: no picture.
  std::function<void(Editor&, const Rect&, const std::vector<FormField>&)> picture;
};
std::unique_ptr<Dialog> make_form(FormRequest request);

}  // namespace limber::editor
