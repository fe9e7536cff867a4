// SPDX-License-Identifier: AGPL-3.0-or-later
// Sends the events of a keyboard for a text: key down, character and key up for each letter.
#pragma once

#include <cctype>
#include <string_view>

#include "editor/app/headless_window.h"

namespace limber::test {

inline void press_key(editor::Offscreen& host, editor::Key key) {
  host.events.push(editor::KeyChanged{key, true});
  host.events.push(editor::KeyChanged{key, false});
}

// Returns the key for a letter, a digit or a space.
inline editor::Key key_of(char c) {
  using editor::Key;
  if (c == ' ') return Key::Space;
  if (std::isdigit(static_cast<unsigned char>(c))) return static_cast<Key>(static_cast<int>(Key::Digit0) + c - '0');
  return static_cast<Key>(static_cast<int>(Key::A) + std::toupper(static_cast<unsigned char>(c)) - 'A');
}

inline void type_keys(editor::Offscreen& host, std::string_view text) {
  for (const char c : text) {
    host.events.push(editor::KeyChanged{key_of(c), true});
    host.events.push(editor::TextTyped{static_cast<char32_t>(c)});
    host.events.push(editor::KeyChanged{key_of(c), false});
  }
}

}  // namespace limber::test
