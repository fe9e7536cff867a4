// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/input/events.h"

#include <algorithm>
#include <utility>

namespace limber::editor {

namespace {

// Returns true if the key only inserts its character into a text field.
bool inserts(Key key, const Modifiers& held) {
  const bool printed =
      (key >= Key::A && key <= Key::Digit9) || key == Key::Space || (key >= Key::Comma && key <= Key::NumPlus);
  return printed && !held.ctrl && !held.alt;
}

// Summarizes the events that a frame has taken so far. fits() tells whether the frame can also take a given event.
struct Seen {
  KeysFor keys_for;
  Modifiers held;
  bool buttons[3] = {};
  bool keys[static_cast<std::size_t>(Key::Count)] = {};
  bool any_button = false, any_key = false, wheel = false, text = false;

  bool fits(const PointerMoved&) const { return !any_button && !wheel && !any_key; }
  bool fits(const ButtonChanged& event) const {
    return !buttons[static_cast<std::size_t>(event.button)] && !wheel && !any_key && !text;
  }
  bool fits(const Wheeled&) const { return !any_button && !any_key; }
  bool fits(const KeyChanged& event) const {
    if (any_button || wheel) return false;
    if (event.key == Key::Ctrl && event.down && text) return false;  // ImGui ignores typed text while Ctrl is down
    if (keys_for == KeysFor::Text && !any_key && (event.key >= Key::Ctrl || inserts(event.key, held))) return true;
    return !keys[static_cast<std::size_t>(event.key)] && !text && !(keys_for == KeysFor::Text && any_key);
  }
  bool fits(const TextTyped&) const { return !any_button && !(keys_for == KeysFor::Text && any_key); }
  bool fits(const FilesDropped&) const { return !any_button && !any_key; }
  bool fits(const FocusChanged&) const { return !any_button && !any_key; }

  void add(const ButtonChanged& event) { any_button = buttons[static_cast<std::size_t>(event.button)] = true; }
  void add(const Wheeled&) { wheel = true; }
  void add(const TextTyped&) { text = true; }
  void add(const KeyChanged& event) {
    if (event.key == Key::Ctrl) held.ctrl = event.down;
    if (event.key == Key::Alt) held.alt = event.down;
    const bool together = keys_for == KeysFor::Text && (event.key >= Key::Ctrl || inserts(event.key, held));
    // A modifier key (Ctrl, Shift, ...) does not count as a key here. The key or button that it modifies may then be
    // taken in the same frame.
    if (event.key < Key::Ctrl && !together) any_key = true;
    keys[static_cast<std::size_t>(event.key)] = !together;
  }
  template <class Other>
  void add(const Other&) {}
};

}  // namespace

void EventQueue::push(Event event) {
  const std::lock_guard lock(mutex_);
  events_.push_back(std::move(event));
}

std::vector<Event> EventQueue::take_frame(KeysFor keys, Modifiers held) {
  const std::lock_guard lock(mutex_);
  std::vector<Event> frame;
  Seen seen{.keys_for = keys, .held = held};
  while (!events_.empty() && std::visit([&](const auto& event) { return seen.fits(event); }, events_.front())) {
    std::visit([&](const auto& event) { seen.add(event); }, events_.front());
    frame.push_back(std::move(events_.front()));
    events_.pop_front();
  }
  return frame;
}

bool EventQueue::empty() const {
  const std::lock_guard lock(mutex_);
  return events_.empty();
}

void InputState::apply(const Event& event) {
  if (const auto* moved = std::get_if<PointerMoved>(&event)) pointer = moved->position;
  if (const auto* button = std::get_if<ButtonChanged>(&event))
    buttons[static_cast<std::size_t>(button->button)] = button->down;
  if (const auto* wheeled = std::get_if<Wheeled>(&event)) {
    wheel += wheeled->steps;
    wheel_sideways += wheeled->sideways;
  }
  if (const auto* key = std::get_if<KeyChanged>(&event)) keys[static_cast<std::size_t>(key->key)] = key->down;
  // While another window has the focus, the editor gets no event for keys and buttons that are released. All of them
  // therefore count as released when the focus is lost.
  if (const auto* focus = std::get_if<FocusChanged>(&event); focus && !focus->focused) {
    std::fill(std::begin(buttons), std::end(buttons), false);
    std::fill(std::begin(keys), std::end(keys), false);
  }
}

}  // namespace limber::editor
