// SPDX-License-Identifier: AGPL-3.0-or-later
// A number that the user types while a transform tool is active: digits, a sign and a decimal point.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

#include "editor/input/keys.h"

namespace limber::editor {

class TypedNumber {
 public:
  // Adds the character of a pressed key to the number; Backspace removes the last character. Returns false if the key
  // does not belong to a number.
  bool key(Key key) {
    if (const char digit = digit_of(key)) {
      if (std::ssize(text_) < kDigits) text_ += digit;
    } else if ((key == Key::Period || key == Key::NumPeriod || key == Key::Comma)) {
      if (text_.find('.') == std::string::npos) text_ += '.';
    } else if (key == Key::Minus || key == Key::NumMinus) {
      negative_ = !negative_;
      typed_ = true;
    } else if (key == Key::Backspace) {
      if (text_.empty()) typed_ = negative_ = false;
      else text_.pop_back();
      if (text_.empty() && !negative_) typed_ = false;
      return true;
    } else {
      return false;
    }
    typed_ = true;
    return true;
  }
  // Sets the number to a value, as if the user had typed it.
  void set(double value) {
    exact_ = value;
    typed_ = true;
  }
  bool typed() const { return typed_; }
  double value() const { return exact_ ? *exact_ : (negative_ ? -1 : 1) * std::strtod(text_.c_str(), nullptr); }
  std::string text() const { return (negative_ ? "-" : "") + text_; }

 private:
  static constexpr int kDigits = 9;

  static char digit_of(Key key) {
    if (key >= Key::Digit0 && key <= Key::Digit9)
      return static_cast<char>('0' + (static_cast<int>(key) - static_cast<int>(Key::Digit0)));
    if (key >= Key::Num0 && key <= Key::Num9)
      return static_cast<char>('0' + (static_cast<int>(key) - static_cast<int>(Key::Num0)));
    return 0;
  }

  std::string text_;
  bool negative_ = false, typed_ = false;
  std::optional<double> exact_;
};

}  // namespace limber::editor
