// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/keyboard.h"

#include <imgui_internal.h>

#include "editor/editor.h"

namespace limber::editor {

namespace {

constexpr int kTurnsToAppear = 2;  // of a field that something asks for
constexpr int kTurnsToFocus = 4;   // until ImGui has given it the keyboard

bool active_item_is_text() {
  const ImGuiContext& imgui = *ImGui::GetCurrentContext();
  return imgui.ActiveId != 0 && imgui.InputTextState.ID == imgui.ActiveId;
}

}  // namespace

void await_field(Editor& editor) {
  editor.keyboard.awaited = 0;
  editor.keyboard.turns = std::max(editor.keyboard.turns, kTurnsToAppear);
  editor.touch();
}

void await_field(Editor& editor, unsigned id) {
  editor.keyboard.awaited = id;
  editor.keyboard.turns = kTurnsToFocus;
  editor.touch();
}

void follow_keyboard(Editor& editor) {
  Keyboard& keyboard = editor.keyboard;
  const ImGuiContext& imgui = *ImGui::GetCurrentContext();
  keyboard.typed = active_item_is_text() && imgui.WantTextInputNextFrame == 1;
  if (keyboard.turns > 0) --keyboard.turns;
  if (keyboard.typed && keyboard.awaited == imgui.ActiveId) keyboard.turns = 0;
  if (keyboard.turns == 0) keyboard.awaited = 0;
}

bool is_typing(const Editor& editor) { return editor.keyboard.typed && active_item_is_text(); }

bool may_interrupt(const Editor& editor) {
  const bool pressed = std::any_of(std::begin(editor.input.buttons), std::end(editor.input.buttons), [](bool down) { return down; });
  return editor.host.events.empty() && !editor.keyboard.typed && !editor.keyboard.waits() && !pressed && !editor.modal && !editor.drag && !editor.dialog && editor.messages.errors.empty() &&
         !ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
}

}  // namespace limber::editor
