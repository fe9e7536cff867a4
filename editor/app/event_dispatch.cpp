// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/app/event_dispatch.h"

#include <imgui.h>
#include <imgui_internal.h>

#include "editor/context/pointer_context.h"
#include "editor/rig/rig_edits.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/ui/keyboard.h"
#include "editor/ui/list_navigation.h"

namespace limber::editor {

namespace {

constexpr float kDragThreshold = 4;    // a press becomes a drag when the pointer has moved this far, px at scale 1
constexpr double kLongestClick = 0.3;  // a press that takes longer is not a click, s

bool dialog_open(const Editor& editor) { return editor.dialog || !editor.messages.errors.empty(); }

// Returns true if a chord belongs to the focused text field, even if the field does not use it. Chords with Alt belong
// to the field, because they type characters on many keyboard layouts.
bool belongs_to_text(const Chord& chord) {
  if (chord.key >= Key::F1 && chord.key <= Key::F12) return false;
  if (!chord.modifiers.ctrl || chord.modifiers.alt) return true;
  constexpr Key kEditing[] = {Key::A, Key::C, Key::V, Key::X, Key::Y, Key::Z};
  const bool moves =
      chord.key >= Key::Space && chord.key <= Key::End && chord.key != Key::PageUp && chord.key != Key::PageDown;
  return moves || std::find(std::begin(kEditing), std::end(kEditing), chord.key) != std::end(kEditing);
}

// Returns true if the start screen uses the key to select a recent file.
bool belongs_to_start_screen(const Chord& chord) {
  return chord.modifiers == Modifiers{} && (chord.key == Key::Up || chord.key == Key::Down || chord.key == Key::Return);
}

void run_chord(Editor& editor, const Chord& chord) {
  if (editor.start_screen && belongs_to_start_screen(chord)) return;
  // Any other key that is bound to a command closes the start screen and runs the command.
  if (editor.start_screen && editor.keymap.find(chord, contexts(editor))) editor.start_screen = false;
  if (const std::string* id = editor.keymap.find(chord, contexts(editor))) run(editor, *id);
}

void end_modal(Editor& editor, bool goes_on) {
  if (!goes_on) editor.modal.reset();
}

void on_key(Editor& editor, const KeyChanged& event) {
  if (editor.modal) return end_modal(editor, editor.modal->key(editor, event));
  if (!event.down || event.key >= Key::Ctrl) return;
  if (event.key == Key::Escape) {
    if (editor.views->preview_visibility || editor.views->preview_tissues || editor.views->preview_armature) {
      editor.views->preview_armature.reset();
      editor.views->preview_visibility.reset();
      editor.views->preview_tissues.reset();
    } else if (editor.drag) {
      if (editor.drag->cancelled) editor.drag->cancelled(editor);
      editor.drag.reset();
    } else if (!editor.messages.errors.empty()) {
      editor.messages.errors.erase(editor.messages.errors.begin());
    } else if (ImGui::GetCurrentContext()->OpenPopupStack.Size > 0) {
      ImGui::ClosePopupToLevel(0, true);
    } else if (editor.dialog) {
      editor.dialog->escape(editor);
    } else if (!editor.list_focus.list.empty()) {
      editor.list_focus = {};
    } else {
      editor.start_screen = false;
    }
    return;
  }
  if (!editor.messages.errors.empty() && (event.key == Key::Return || event.key == Key::NumEnter)) {
    editor.messages.errors.erase(editor.messages.errors.begin());
    return;
  }
  const Chord chord{Chord::Kind::Key, editor.input.modifiers(), event.key};
  if (editor.drag || !editor.messages.errors.empty()) return;
  if (editor.dialog) {
    editor.dialog->key(editor, chord);
    return;
  }
  if (is_typing(editor)) {
    // While a text field has the keyboard, keys run only commands of the context "global".
    const std::string* id = belongs_to_text(chord) ? nullptr : editor.keymap.find(chord, {"global"});
    if (id) run(editor, *id);
    return;
  }
  if (ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId) || list_takes(editor, chord)) return;
  run_chord(editor, chord);
}

// Handles the press of a button in a view or the timeline. The press may become a drag.
void on_press(Editor& editor, MouseButton button) {
  editor.list_focus = {};
  const ViewPlace* view = hovered_view(editor);
  if (!(view || over_timeline(editor)) || editor.drag || dialog_open(editor)) return;
  if (button == MouseButton::Left && over_widget(editor)) return;
  if (view) editor.views->active = view->id;
  if (view && button == MouseButton::Left && press_gizmo(editor)) return;
  const Modifiers modifiers = editor.input.modifiers();
  const Chord press{Chord::Kind::Press, modifiers, Key::None, button},
      drag{Chord::Kind::Drag, modifiers, Key::None, button};
  if (!editor.keymap.find(drag, contexts(editor))) return run_chord(editor, press);
  editor.pending_press = {press, drag, editor.input.pointer, editor.now};
}

void on_release(Editor& editor, MouseButton button) {
  if (editor.pending_press && editor.pending_press->press.button == button) {
    const PendingPress pending = *editor.pending_press;
    editor.pending_press.reset();
    if (editor.now - pending.since < kLongestClick) run_chord(editor, pending.press);
  }
  if (!editor.drag || editor.drag->button != button) return;
  const Drag ended = std::move(*editor.drag);
  editor.drag.reset();
  if (ended.ended) ended.ended(editor);
}

void on_move(Editor& editor, const glm::vec2& from, const glm::vec2& to) {
  const auto outside = [](const glm::vec2& point) { return point.x < -1e5f; };
  if (outside(from) || outside(to)) return;
  if (editor.modal) {
    end_modal(editor, editor.modal->moved(editor, editor.modal_wrap.moved(from, to)));
    if (const glm::vec2 leap = editor.modal_wrap.leap(to); editor.modal && leap != glm::vec2(0))
      editor.host.shift_pointer(leap);
    return;
  }
  if (from != to && hovered_view(editor)) editor.list_focus = {};
  if (editor.pending_press &&
      glm::distance(editor.pending_press->from, editor.input.pointer) >= kDragThreshold * editor.look.scale) {
    const PendingPress pending = *editor.pending_press;
    editor.pending_press.reset();
    run_chord(editor, pending.drag);
    if (editor.drag && editor.drag->moved) editor.drag->moved(editor, editor.input.pointer - pending.from);
    return;
  }
  if (!editor.drag || !editor.drag->moved) return;
  editor.drag->moved(editor, editor.drag->wrap.moved(from, to));
  if (const glm::vec2 leap = editor.drag->wrap.leap(to); leap != glm::vec2(0)) editor.host.shift_pointer(leap);
}

void on_wheel(Editor& editor, const Wheeled& event) {
  if (editor.modal) return end_modal(editor, editor.modal->wheel(editor, event.steps));
  if (!(hovered_view(editor) || over_timeline(editor)) || editor.drag || dialog_open(editor)) return;
  editor.input.wheel = event.steps;
  editor.input.wheel_sideways = event.sideways;
  if (event.steps != 0) run_chord(editor, {Chord::Kind::Wheel, editor.input.modifiers()});
  if (event.sideways != 0 && hovered_view(editor)) run(editor, "view.pan_sideways_step");
}

}  // namespace

bool may_interrupt(const Editor& editor) {
  const bool pressed =
      std::any_of(std::begin(editor.input.buttons), std::end(editor.input.buttons), [](bool down) { return down; });
  return editor.host.events.empty() && !editor.keyboard.typed && !editor.keyboard.waits() && !pressed &&
         !editor.modal && !editor.drag && !editor.dialog && editor.messages.errors.empty() &&
         !ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
}

void dispatch(Editor& editor, const std::vector<Event>& events, InputState before) {
  const InputState after = editor.input;
  drop_missing_bones(editor);
  for (const Event& event : events) {
    const glm::vec2 from = before.pointer;
    before.apply(event);
    editor.input = before;
    if (std::holds_alternative<PointerMoved>(event)) {
      on_move(editor, from, before.pointer);
    } else if (const auto* button = std::get_if<ButtonChanged>(&event)) {
      if (editor.modal) end_modal(editor, editor.modal->button(editor, *button));
      else button->down ? on_press(editor, button->button) : on_release(editor, button->button);
    } else if (const auto* wheel = std::get_if<Wheeled>(&event)) {
      on_wheel(editor, *wheel);
    } else if (const auto* key = std::get_if<KeyChanged>(&event)) {
      on_key(editor, *key);
    } else if (const auto* dropped = std::get_if<FilesDropped>(&event)) {
      editor.to_open.insert(editor.to_open.end(), dropped->paths.begin(), dropped->paths.end());
    } else if (const auto* focus = std::get_if<FocusChanged>(&event); focus && !focus->focused) {
      editor.pending_press.reset();
      if (editor.drag && editor.drag->ended) editor.drag->ended(editor);
      editor.drag.reset();
      if (editor.modal) editor.modal->cancel(editor);
      editor.modal.reset();
    }
  }
  editor.input = after;
}

}  // namespace limber::editor
