// SPDX-License-Identifier: AGPL-3.0-or-later
// What the user did, in order. The window's callbacks, scripts and tests push events into one queue; each frame takes
// from it as much as cannot be mistaken: it stops before the second change of a key or button, before a move that
// follows a press, before text that follows another text's key. So a key pressed and released between two frames is
// seen twice: down in one frame, up in the next. While a text field has the keyboard, keys that only insert a character
// go together, up to the next one that does more, such as Backspace. Nothing is dropped.
#pragma once

#include <deque>
#include <mutex>
#include <variant>
#include <vector>

#include <glm/glm.hpp>

#include "core/base/file.h"
#include "editor/input/keys.h"

namespace limber::editor {

struct PointerMoved {
  glm::vec2 position;  // pixels of the window's picture
};
struct ButtonChanged {
  MouseButton button;
  bool down;
};
struct Wheeled {
  float steps;         // positive: away from the user
  float sideways = 0;  // of two fingers on a pad; positive: to the left
};
struct KeyChanged {
  Key key;
  bool down;
  bool repeated = false;  // held down
};
struct TextTyped {
  char32_t character;
};
struct FilesDropped {
  std::vector<Path> paths;
};
struct FocusChanged {
  bool focused;
};
using Event = std::variant<PointerMoved, ButtonChanged, Wheeled, KeyChanged, TextTyped, FilesDropped, FocusChanged>;

enum class KeysFor { Commands, Text };

class EventQueue {
 public:
  void push(Event event);
  // The events of the next frame, taken out. `held` are the modifiers that are down before them.
  std::vector<Event> take_frame(KeysFor keys = KeysFor::Commands, Modifiers held = {});
  bool empty() const;

 private:
  mutable std::mutex mutex_;
  std::deque<Event> events_;
};

// Which keys and buttons are down and where the pointer is, after events.
struct InputState {
  glm::vec2 pointer{-1e6f};  // outside every region
  bool buttons[3] = {};
  bool keys[static_cast<std::size_t>(Key::Count)] = {};
  float wheel = 0, wheel_sideways = 0;  // of this frame

  bool down(Key key) const { return keys[static_cast<std::size_t>(key)]; }
  bool down(MouseButton button) const { return buttons[static_cast<std::size_t>(button)]; }
  Modifiers modifiers() const { return {down(Key::Ctrl), down(Key::Shift), down(Key::Alt)}; }
  void apply(const Event& event);
};

// Gives a frame's events to the current ImGui context, before ImGui::NewFrame. `state` is the one after them.
void tell_imgui(const std::vector<Event>& events, const InputState& state);
// Once per context: which of our keys are ImGui's.
void teach_imgui_keys();

}  // namespace limber::editor
