// SPDX-License-Identifier: AGPL-3.0-or-later
// A dialog of a few fields and one thing to do with them. Enter does it, Escape leaves.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

struct FormField {
  std::string label;
  std::string description;  // its tool tip

  enum class Kind { Number, Choice, Text, Fact } kind = Kind::Number;
  double value = 0, low = 0, high = 1;  // of a number
  const char* format = "%.0f";
  const char* unit = "";
  std::vector<std::string> choices;  // of a choice; up to four stand beside one another, more in a list
  int chosen = 0;
  std::string text;  // of a text; of a fact, which cannot be changed
};
FormField number_of(std::string label, std::string description, double value, double low, double high,
                    const char* format, const char* unit = "");
FormField choice_of(std::string label, std::string description, std::vector<std::string> choices, int chosen = 0);

FormField text_of(std::string label, std::string description, std::string text);
FormField fact_of(std::string label, std::string text);

// Nothing is wrong, but the fields ask for nothing yet.
struct NotYet {
  std::string words;
};

// What becomes of a number that is typed outside its range: the nearest in it, or it stays, to be refused.
enum class OutOfRange { Clamped, Stays };

// A row of a field, its label so wide at its left. True when its value was changed: numbers once they are let go, or
// typed.
//   focus  what is typed goes into it
bool draw_field(Editor& editor, FormField& field, const Rect& row, float label_width, bool focus = false,
                OutOfRange numbers = OutOfRange::Clamped);

// A number outside its range is refused with a line under its field, and the button waits. The first field that is
// typed into has the keyboard.
struct FormRequest {
  std::string title;
  std::string description;  // what it does, above the fields
  std::string action;       // the primary button's word
  std::vector<FormField> fields;
  // Below the fields, anew whenever they change: what will come out of it. Throws Error for what cannot be done: shown
  // in place of it, and the button waits. So it does without a warning where a NotYet is thrown.
  std::function<std::string(const Editor&, const std::vector<FormField>&)> outcome;
  std::function<void(Editor&, const std::vector<FormField>&)> act;
  // Beside the fields, where there is one: what the fields mean, as a picture.
  std::function<void(Editor&, const Rect&, const std::vector<FormField>&)> picture;
};
std::unique_ptr<Dialog> make_form(FormRequest request);

}  // namespace limber::editor
