// SPDX-License-Identifier: AGPL-3.0-or-later
// Keys, mouse buttons and the chords made of them, with the names that key maps, menus and recordings use:
// "Ctrl+Shift+Z", "Alt+LMBdrag", "Num.", "Wheel", "`". Letters and digits follow the user's keyboard layout.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace limber::editor {

// clang-format off
enum class Key : std::uint8_t {
  None,
  A, B, C, D, E, F, G, H, I, J, K, L, M, N, O, P, Q, R, S, T, U, V, W, X, Y, Z,
  Digit0, Digit1, Digit2, Digit3, Digit4, Digit5, Digit6, Digit7, Digit8, Digit9,
  F1, F2, F3, F4, F5, F6, F7, F8, F9, F10, F11, F12,
  Space, Tab, Return, Escape, Backspace, Delete, Insert,
  Left, Right, Up, Down, PageUp, PageDown, Home, End,
  Comma, Period, Minus, Plus, Slash, Semicolon, Quote, Backslash, BracketLeft, BracketRight, Backtick,
  Num0, Num1, Num2, Num3, Num4, Num5, Num6, Num7, Num8, Num9, NumPeriod, NumSlash, NumTimes, NumMinus, NumPlus,
  NumEnter,
  Ctrl, Shift, Alt, Super,
  Count,
};
// clang-format on

std::string_view name_of(Key key);
std::optional<Key> key_from_name(std::string_view name);

enum class MouseButton : std::uint8_t { Left, Right, Middle };

struct Modifiers {
  bool ctrl = false, shift = false, alt = false;

  bool operator==(const Modifiers&) const = default;
};

// A key, button press, drag or wheel step, together with its modifiers. If both the press and the drag of a button are
// bound, the press runs its operator only when the button is released without a drag, as a click.
struct Chord {
  enum class Kind { Key, Press, Drag, Wheel } kind = Kind::Key;
  Modifiers modifiers;
  Key key = Key::None;
  MouseButton button = MouseButton::Left;

  bool operator==(const Chord&) const = default;
};

std::optional<Chord> chord_from_text(std::string_view text);
std::string to_text(const Chord& chord);                // returns the text of a chord, such as "Ctrl+Shift+Z"
std::vector<std::string> key_caps(const Chord& chord);  // returns the names of the chord's keys: "Ctrl", "Shift", "Z"

}  // namespace limber::editor
