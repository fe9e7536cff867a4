// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/input/events.h"

#include <imgui.h>

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

void teach_imgui_keys() {
  constexpr std::pair<ImGuiKey, Key> kKeys[] = {{ImGuiKey_Tab, Key::Tab},
                                                {ImGuiKey_LeftArrow, Key::Left},
                                                {ImGuiKey_RightArrow, Key::Right},
                                                {ImGuiKey_UpArrow, Key::Up},
                                                {ImGuiKey_DownArrow, Key::Down},
                                                {ImGuiKey_PageUp, Key::PageUp},
                                                {ImGuiKey_PageDown, Key::PageDown},
                                                {ImGuiKey_Home, Key::Home},
                                                {ImGuiKey_End, Key::End},
                                                {ImGuiKey_Insert, Key::Insert},
                                                {ImGuiKey_Delete, Key::Delete},
                                                {ImGuiKey_Backspace, Key::Backspace},
                                                {ImGuiKey_Space, Key::Space},
                                                {ImGuiKey_Enter, Key::Return},
                                                {ImGuiKey_Escape, Key::Escape},
                                                {ImGuiKey_KeyPadEnter, Key::NumEnter},
                                                {ImGuiKey_A, Key::A},
                                                {ImGuiKey_C, Key::C},
                                                {ImGuiKey_V, Key::V},
                                                {ImGuiKey_X, Key::X},
                                                {ImGuiKey_Y, Key::Y},
                                                {ImGuiKey_Z, Key::Z}};
  for (const auto& [theirs, ours] : kKeys) ImGui::GetIO().KeyMap[theirs] = static_cast<int>(ours);
}

void tell_imgui(const std::vector<Event>& events, const InputState& state) {
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = state.pointer.x < -1e5f ? ImVec2(-FLT_MAX, -FLT_MAX) : ImVec2(state.pointer.x, state.pointer.y);
  for (int button = 0; button < 3; ++button) io.MouseDown[button] = state.buttons[button];
  io.MouseWheel = state.wheel;
  io.MouseWheelH = state.wheel_sideways;
  for (std::size_t key = 0; key < static_cast<std::size_t>(Key::Count); ++key) io.KeysDown[key] = state.keys[key];
  io.KeyCtrl = state.down(Key::Ctrl);
  if (io.KeyCtrl) io.KeysDown[static_cast<std::size_t>(Key::Tab)] = false;  // Ctrl+Tab would open a list of windows
  io.KeyShift = state.down(Key::Shift);
  io.KeyAlt = state.down(Key::Alt);
  io.KeySuper = state.down(Key::Super);
  for (const Event& event : events) {
    if (const auto* text = std::get_if<TextTyped>(&event)) io.AddInputCharacter(text->character);
    if (const auto* focus = std::get_if<FocusChanged>(&event)) io.AddFocusEvent(focus->focused);
  }
}

}  // namespace limber::editor
