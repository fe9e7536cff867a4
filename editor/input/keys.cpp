// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/input/keys.h"

#include <array>

namespace limber::editor {

namespace {

// clang-format off
constexpr std::array<std::string_view, static_cast<std::size_t>(Key::Count)> kNames = {
  "",
  "A", "B", "C", "D", "E", "F", "G", "H", "I", "J", "K", "L", "M", "N", "O", "P", "Q", "R", "S", "T", "U", "V", "W",
    "X", "Y", "Z",
  "0", "1", "2", "3", "4", "5", "6", "7", "8", "9",
  "F1", "F2", "F3", "F4", "F5", "F6", "F7", "F8", "F9", "F10", "F11", "F12",
  "Space", "Tab", "Return", "Escape", "Backspace", "Delete", "Insert",
  "Left", "Right", "Up", "Down", "PageUp", "PageDown", "Home", "End",
  ",", ".", "-", "+", "/", ";", "'", "\\", "[", "]", "`",
  "Num0", "Num1", "Num2", "Num3", "Num4", "Num5", "Num6", "Num7", "Num8", "Num9", "Num.", "Num/", "Num*", "Num-",
    "Num+", "NumEnter",
  "Ctrl", "Shift", "Alt", "Super",
};
// clang-format on

constexpr std::string_view kButtons[] = {"LMB", "RMB", "MMB"};

bool take(std::string_view& text, std::string_view beginning) {
  if (!text.starts_with(beginning)) return false;
  text.remove_prefix(beginning.size());
  return true;
}

}  // namespace

std::string_view name_of(Key key) { return kNames[static_cast<std::size_t>(key)]; }

std::optional<Key> key_from_name(std::string_view name) {
  for (std::size_t i = 1; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<Key>(i);
  return std::nullopt;
}

std::optional<Chord> chord_from_text(std::string_view text) {
  Chord chord;
  for (;;) {
    if (take(text, "Ctrl+")) chord.modifiers.ctrl = true;
    else if (take(text, "Shift+")) chord.modifiers.shift = true;
    else if (take(text, "Alt+")) chord.modifiers.alt = true;
    else break;
  }
  if (text == "Wheel") {
    chord.kind = Chord::Kind::Wheel;
    return chord;
  }
  for (std::size_t button = 0; button < 3; ++button) {
    if (!text.starts_with(kButtons[button])) continue;
    const std::string_view rest = text.substr(kButtons[button].size());
    if (!rest.empty() && rest != "drag") return std::nullopt;
    chord.kind = rest.empty() ? Chord::Kind::Press : Chord::Kind::Drag;
    chord.button = static_cast<MouseButton>(button);
    return chord;
  }
  const auto key = key_from_name(text);
  if (!key) return std::nullopt;
  chord.key = *key;
  return chord;
}

std::vector<std::string> key_caps(const Chord& chord) {
  std::vector<std::string> caps;
  if (chord.modifiers.ctrl) caps.push_back("Ctrl");
  if (chord.modifiers.shift) caps.push_back("Shift");
  if (chord.modifiers.alt) caps.push_back("Alt");
  switch (chord.kind) {
    case Chord::Kind::Key: caps.emplace_back(name_of(chord.key)); break;
    case Chord::Kind::Wheel: caps.push_back("Wheel"); break;
    case Chord::Kind::Press:
    case Chord::Kind::Drag: caps.emplace_back(kButtons[static_cast<std::size_t>(chord.button)]); break;
  }
  return caps;
}

std::string to_text(const Chord& chord) {
  std::string text;
  for (const std::string& cap : key_caps(chord)) text += (text.empty() ? "" : "+") + cap;
  return chord.kind == Chord::Kind::Drag ? text + "drag" : text;
}

}  // namespace limber::editor
