// SPDX-License-Identifier: AGPL-3.0-or-later
// Passes the user's input to ImGui. This code is in a file of its own, because the window module contains the event
// queue but not ImGui.
#include <cfloat>
#include <utility>

#include <imgui.h>

#include "editor/input/events.h"

namespace limber::editor {

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
