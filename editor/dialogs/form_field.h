// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace limber::editor {

struct Context;
struct Rect;

struct FormField {
  std::string label;
  std::string description;  // the field's tool tip

  enum class Kind { Number, Choice, Text, Fact } kind = Kind::Number;
  double value = 0, low = 0, high = 1;  // value and range [low, high] of a Number field
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

}  // namespace limber::editor
