// SPDX-License-Identifier: AGPL-3.0-or-later
// The queue of the user's input events, which the window's callbacks, scripts and tests push. ImGui sees only the state
// after all events of a frame, not their order. So a frame takes events only as long as their order does not matter: it
// stops before the second change of the same key or button, before a pointer move that follows a press, and before a
// key that follows typed text. A key that is pressed and released between two frames is thus down in one frame and up
// in the next. While a text field has the keyboard, one frame takes all keys that only insert a character, up to the
// next key that does more, such as Backspace. No event is dropped.
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
  glm::vec2 position;  // position of the pointer, pixels of the window
};
struct ButtonChanged {
  MouseButton button;
  bool down;
};
struct Wheeled {
  float steps;         // steps of the mouse wheel; positive: turned away from the user
  float sideways = 0;  // steps of a sideways swipe on a touch pad; positive: to the left
};
struct KeyChanged {
  Key key;
  bool down;
  bool repeated = false;  // true: sent again because the key is held down
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
  // Takes the events of the next frame out of the queue. `held` are the modifier keys that are down before these
  // events.
  std::vector<Event> take_frame(KeysFor keys = KeysFor::Commands, Modifiers held = {});
  bool empty() const;

 private:
  mutable std::mutex mutex_;
  std::deque<Event> events_;
};

// The state of the keys, the mouse buttons and the pointer after all events that were passed to apply().
struct InputState {
  glm::vec2 pointer{-1e6f};  // position of the pointer, pixels; at first outside the window
  bool buttons[3] = {};
  bool keys[static_cast<std::size_t>(Key::Count)] = {};
  float wheel = 0, wheel_sideways = 0;  // steps of the mouse wheel in this frame

  bool down(Key key) const { return keys[static_cast<std::size_t>(key)]; }
  bool down(MouseButton button) const { return buttons[static_cast<std::size_t>(button)]; }
  Modifiers modifiers() const { return {down(Key::Ctrl), down(Key::Shift), down(Key::Alt)}; }
  void apply(const Event& event);
};

// Passes a frame's events to the current ImGui context. `state` is the input state after these events. Call it before
// ImGui::NewFrame.
void tell_imgui(const std::vector<Event>& events, const InputState& state);
// Tells the current ImGui context which Key corresponds to each of ImGui's keys. Call it once per context.
void teach_imgui_keys();

}  // namespace limber::editor
