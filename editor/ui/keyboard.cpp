// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/keyboard.h"

#include <imgui_internal.h>

#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

constexpr int kTurnsToAppear = 2;  // number of frames for which pressed keys wait for a requested text field to appear
// Number of frames for which pressed keys wait until ImGui gives the requested field the keyboard.
constexpr int kTurnsToFocus = 4;

bool active_item_is_text() {
  const ImGuiContext& imgui = *ImGui::GetCurrentContext();
  return imgui.ActiveId != 0 && imgui.InputTextState.ID == imgui.ActiveId;
}

}  // namespace

void await_field(Ui& ui) {
  ui.keyboard.awaited = 0;
  ui.keyboard.turns = std::max(ui.keyboard.turns, kTurnsToAppear);
  ui.touch();
}

void await_field(Ui& ui, unsigned id) {
  ui.keyboard.awaited = id;
  ui.keyboard.turns = kTurnsToFocus;
  ui.touch();
}

void follow_keyboard(Ui& ui) {
  Keyboard& keyboard = ui.keyboard;
  const ImGuiContext& imgui = *ImGui::GetCurrentContext();
  keyboard.typed = active_item_is_text() && imgui.WantTextInputNextFrame == 1;
  if (keyboard.turns > 0) --keyboard.turns;
  if (keyboard.typed && keyboard.awaited == imgui.ActiveId) keyboard.turns = 0;
  if (keyboard.turns == 0) keyboard.awaited = 0;
}

bool is_typing(const Ui& ui) { return ui.keyboard.typed && active_item_is_text(); }

}  // namespace limber::editor
