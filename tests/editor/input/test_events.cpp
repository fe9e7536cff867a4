// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/input/events.h"

#include <doctest/doctest.h>

#include "editor/input/keys.h"

using namespace limber::editor;

TEST_CASE("events: a key pressed and released between two frames is down in one and up in the next") {
  EventQueue queue;
  queue.push(KeyChanged{Key::G, true});
  queue.push(KeyChanged{Key::G, false});
  queue.push(KeyChanged{Key::G, true});
  CHECK(queue.take_frame().size() == 1);
  CHECK(queue.take_frame().size() == 1);
  CHECK(queue.take_frame().size() == 1);
  CHECK(queue.empty());
}

TEST_CASE("events: a press is seen where it happened, though the pointer moved on within the frame") {
  EventQueue queue;
  queue.push(PointerMoved{{10, 10}});
  queue.push(ButtonChanged{MouseButton::Left, true});
  queue.push(PointerMoved{{50, 10}});
  queue.push(ButtonChanged{MouseButton::Left, false});
  InputState state;
  for (const Event& event : queue.take_frame()) state.apply(event);
  CHECK(state.pointer == glm::vec2(10, 10));
  CHECK(state.down(MouseButton::Left));
  for (const Event& event : queue.take_frame()) state.apply(event);
  CHECK(state.pointer == glm::vec2(50, 10));
  CHECK_FALSE(state.down(MouseButton::Left));
}

TEST_CASE("events: none is lost, whatever their order") {
  EventQueue queue;
  int pushed = 0;
  unsigned random = 1;
  for (int i = 0; i < 2000; ++i, ++pushed) {
    random = random * 1664525 + 1013904223;
    switch (random >> 29) {
      case 0: queue.push(PointerMoved{{float(i), 0}}); break;
      case 1:
      case 2: queue.push(ButtonChanged{static_cast<MouseButton>(random >> 20 & 1), (random >> 16 & 1) != 0}); break;
      case 3: queue.push(Wheeled{1}); break;
      case 4: queue.push(TextTyped{U'a'}); break;
      default: queue.push(KeyChanged{static_cast<Key>(1 + (random >> 20 & 63)), (random >> 16 & 1) != 0});
    }
  }
  int taken = 0;
  while (!queue.empty()) {
    const auto frame = queue.take_frame();
    REQUIRE_FALSE(frame.empty());
    taken += static_cast<int>(frame.size());
  }
  CHECK(taken == pushed);
}

TEST_CASE("events: what is held when the window loses the focus is let go") {
  InputState state;
  state.apply(KeyChanged{Key::Ctrl, true});
  state.apply(ButtonChanged{MouseButton::Middle, true});
  state.apply(FocusChanged{false});
  CHECK(state.modifiers() == Modifiers{});
  CHECK_FALSE(state.down(MouseButton::Middle));
}

TEST_CASE("keys: every chord is written as it is read") {
  for (const char* text : {"Ctrl+Shift+Z", "Alt+LMBdrag", "MMB", "Num.", "Num/", "Wheel", "Shift+Ctrl+Wheel", "`", "+",
                           "-", "Ctrl+,", "[", "F12", "Return", "PageUp"}) {
    const auto chord = chord_from_text(text);
    REQUIRE(chord);
    CHECK(chord_from_text(to_text(*chord)) == chord);
  }
  for (const char* text : {"", "Ctrl+", "Strg+Z", "LMBclick", "F13", "AA"}) CHECK_FALSE(chord_from_text(text));
}
