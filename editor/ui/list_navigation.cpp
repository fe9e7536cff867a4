// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/ui/list_navigation.h"

#include <algorithm>
#include <utility>

#include <imgui.h>

#include "editor/ui/input_fields.h"
#include "editor/ui/keyboard.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

constexpr int kPage = 10;  // number of rows by which PageUp and PageDown move

constexpr Key kMoves[] = {Key::Up, Key::Down, Key::PageUp, Key::PageDown, Key::Home, Key::End};
constexpr std::pair<Key, ListKey> kActs[] = {{Key::Return, ListKey::Activate}, {Key::NumEnter, ListKey::Activate},
                                             {Key::Space, ListKey::Toggle},    {Key::F2, ListKey::Rename},
                                             {Key::Left, ListKey::Fold},       {Key::Right, ListKey::Unfold}};

bool pressed(Key key) { return ImGui::IsKeyPressed(static_cast<int>(key), true); }

bool keyboard_is_free(const Ui& ui) {
  return !ui.dialog_open && !ImGui::GetIO().WantTextInput && !ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId) &&
         ui.input.modifiers() == Modifiers{};
}

}  // namespace

void focus_list(Ui& ui, const std::string& list, int row) {
  ui.list_focus = {list, row, true};
  ui.touch();
}

bool has_focus(const Ui& ui, const std::string& list, int row) {
  return ui.list_focus.list == list && ui.list_focus.row == row;
}

bool list_takes(const Ui& ui, const Chord& chord) {
  if (ui.list_focus.list.empty() || chord.modifiers != Modifiers{}) return false;
  return std::find(std::begin(kMoves), std::end(kMoves), chord.key) != std::end(kMoves) ||
         std::any_of(std::begin(kActs), std::end(kActs), [&](const auto& act) { return act.first == chord.key; });
}

ListKey list_key(Ui& ui, const std::string& list, int rows) {
  ListFocus& focus = ui.list_focus;
  if (focus.list != list) return ListKey::None;
  const int last = std::max(0, rows - 1), before = focus.row;
  if (keyboard_is_free(ui)) {
    if (pressed(Key::Down)) focus.row += 1;
    if (pressed(Key::Up)) focus.row -= 1;
    if (pressed(Key::PageDown)) focus.row += kPage;
    if (pressed(Key::PageUp)) focus.row -= kPage;
    if (pressed(Key::Home)) focus.row = 0;
    if (pressed(Key::End)) focus.row = last;
  }
  focus.row = std::clamp(focus.row, 0, last);
  focus.reveal |= focus.row != before;
  if (rows == 0 || !keyboard_is_free(ui)) return ListKey::None;
  for (const auto& [key, act] : kActs)
    if (pressed(key)) return act;
  return focus.row != before ? ListKey::Moved : ListKey::None;
}

void begin_renaming(Ui& ui, const std::string& what, const std::string& name) {
  ui.renaming = Renaming{what, name};
  await_field(ui);
}

bool is_renaming(const Ui& ui, const std::string& what) { return ui.renaming && ui.renaming->what == what; }

bool rename_field(Ui& ui, const Rect& rect, std::string& name) {
  Renaming& renaming = *ui.renaming;
  const bool first = !std::exchange(renaming.shown, true);
  text_field(ui, "rename", rect, renaming.text, "Name", first);
  if (first || ImGui::IsItemActive()) {
    ui.touch();
    return false;
  }
  // After Escape, ImGui has put the old name back into renaming.text. After Return or a press elsewhere, renaming.text
  // has the new name.
  const std::string accepted = renaming.text;
  const bool over = ImGui::IsItemDeactivated() || !ImGui::GetIO().WantTextInput;
  if (!over) return false;
  ui.renaming.reset();
  ui.touch();
  if (accepted.empty() || accepted == name) return false;
  name = accepted;
  return true;
}

}  // namespace limber::editor
