// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/app/event_dispatch.h"

#include <imgui.h>
#include <imgui_internal.h>

#include "editor/context/context.h"
#include "editor/context/dialogs.h"
#include "editor/context/interaction.h"
#include "editor/context/modal_tool.h"
#include "editor/context/open_project.h"
#include "editor/context/operator.h"
#include "editor/context/platform_window.h"
#include "editor/context/pointer_context.h"
#include "editor/context/start_screen_state.h"
#include "editor/context/views.h"
#include "editor/input/keymap.h"
#include "editor/rig/rig_edits.h"
#include "editor/selection/transform_gizmo.h"
#include "editor/ui/keyboard.h"
#include "editor/ui/list_navigation.h"
#include "editor/ui/messages.h"

namespace limber::editor {

namespace {

constexpr float kDragThreshold = 4;    // a press becomes a drag when the pointer has moved this far, px at scale 1
constexpr double kLongestClick = 0.3;  // a press that takes longer is not a click, s

bool dialog_open(const Context& context) { return context.dialogs->shown || !context.messages->errors.empty(); }

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

void run_chord(Context& context, const Chord& chord) {
  if (context.start_screen->shown && belongs_to_start_screen(chord)) return;
  // Any other key that is bound to a command closes the start screen and runs the command.
  if (context.start_screen->shown && context.keymap->find(chord, contexts(context)))
    context.start_screen->shown = false;
  if (const std::string* id = context.keymap->find(chord, contexts(context))) run(context, *id);
}

void end_modal(Interaction& interaction, bool goes_on) {
  if (!goes_on) interaction.modal.reset();
}

void on_key(Context& context, const KeyChanged& event) {
  if (context.interaction->modal)
    return end_modal(context.interaction, context.interaction->modal->key(context, event));
  if (!event.down || event.key >= Key::Ctrl) return;
  if (event.key == Key::Escape) {
    if (context.views->preview_visibility || context.views->preview_tissues || context.views->preview_armature) {
      context.views->preview_armature.reset();
      context.views->preview_visibility.reset();
      context.views->preview_tissues.reset();
    } else if (context.interaction->drag) {
      if (context.interaction->drag->cancelled) context.interaction->drag->cancelled(context);
      context.interaction->drag.reset();
    } else if (!context.messages->errors.empty()) {
      context.messages->errors.erase(context.messages->errors.begin());
    } else if (ImGui::GetCurrentContext()->OpenPopupStack.Size > 0) {
      ImGui::ClosePopupToLevel(0, true);
    } else if (context.dialogs->shown) {
      context.dialogs->shown->escape(context);
    } else if (!context.ui->list_focus.list.empty()) {
      context.ui->list_focus = {};
    } else {
      context.start_screen->shown = false;
    }
    return;
  }
  if (!context.messages->errors.empty() && (event.key == Key::Return || event.key == Key::NumEnter)) {
    context.messages->errors.erase(context.messages->errors.begin());
    return;
  }
  const Chord chord{Chord::Kind::Key, context.ui->input.modifiers(), event.key};
  if (context.interaction->drag || !context.messages->errors.empty()) return;
  if (context.dialogs->shown) {
    context.dialogs->shown->key(context, chord);
    return;
  }
  if (is_typing(context.ui)) {
    // While a text field has the keyboard, keys run only commands of the context "global".
    const std::string* id = belongs_to_text(chord) ? nullptr : context.keymap->find(chord, {"global"});
    if (id) run(context, *id);
    return;
  }
  if (ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId) || list_takes(context.ui, chord)) return;
  run_chord(context, chord);
}

// Handles the press of a button in a view or the timeline. The press may become a drag.
void on_press(Context& context, MouseButton button) {
  context.ui->list_focus = {};
  const ViewPlace* view = hovered_view(context);
  if (!(view || over_timeline(context)) || context.interaction->drag || dialog_open(context)) return;
  if (button == MouseButton::Left && over_widget(context.ui)) return;
  if (view) context.views->active = view->id;
  if (view && button == MouseButton::Left && press_gizmo(context)) return;
  const Modifiers modifiers = context.ui->input.modifiers();
  const Chord press{Chord::Kind::Press, modifiers, Key::None, button},
      drag{Chord::Kind::Drag, modifiers, Key::None, button};
  if (!context.keymap->find(drag, contexts(context))) return run_chord(context, press);
  context.interaction->pending_press = {press, drag, context.ui->input.pointer, context.ui->now};
}

void on_release(Context& context, MouseButton button) {
  if (context.interaction->pending_press && context.interaction->pending_press->press.button == button) {
    const PendingPress pending = *context.interaction->pending_press;
    context.interaction->pending_press.reset();
    if (context.ui->now - pending.since < kLongestClick) run_chord(context, pending.press);
  }
  if (!context.interaction->drag || context.interaction->drag->button != button) return;
  const Drag ended = std::move(*context.interaction->drag);
  context.interaction->drag.reset();
  if (ended.ended) ended.ended(context);
}

void on_move(Context& context, const glm::vec2& from, const glm::vec2& to) {
  const auto outside = [](const glm::vec2& point) { return point.x < -1e5f; };
  if (outside(from) || outside(to)) return;
  if (context.interaction->modal) {
    end_modal(context.interaction,
              context.interaction->modal->moved(context, context.interaction->modal_wrap.moved(from, to)));
    if (const glm::vec2 leap = context.interaction->modal_wrap.leap(to);
        context.interaction->modal && leap != glm::vec2(0))
      context.host->shift_pointer(leap);
    return;
  }
  if (from != to && hovered_view(context)) context.ui->list_focus = {};
  if (context.interaction->pending_press &&
      glm::distance(context.interaction->pending_press->from, context.ui->input.pointer) >=
          kDragThreshold * context.ui->look.scale) {
    const PendingPress pending = *context.interaction->pending_press;
    context.interaction->pending_press.reset();
    run_chord(context, pending.drag);
    if (context.interaction->drag && context.interaction->drag->moved)
      context.interaction->drag->moved(context, context.ui->input.pointer - pending.from);
    return;
  }
  if (!context.interaction->drag || !context.interaction->drag->moved) return;
  context.interaction->drag->moved(context, context.interaction->drag->wrap.moved(from, to));
  if (const glm::vec2 leap = context.interaction->drag->wrap.leap(to); leap != glm::vec2(0))
    context.host->shift_pointer(leap);
}

void on_wheel(Context& context, const Wheeled& event) {
  if (context.interaction->modal)
    return end_modal(context.interaction, context.interaction->modal->wheel(context, event.steps));
  if (!(hovered_view(context) || over_timeline(context)) || context.interaction->drag || dialog_open(context)) return;
  context.ui->input.wheel = event.steps;
  context.ui->input.wheel_sideways = event.sideways;
  if (event.steps != 0) run_chord(context, {Chord::Kind::Wheel, context.ui->input.modifiers()});
  if (event.sideways != 0 && hovered_view(context)) run(context, "view.pan_sideways_step");
}

}  // namespace

bool may_interrupt(const Context& context) {
  const bool pressed = std::any_of(std::begin(context.ui->input.buttons), std::end(context.ui->input.buttons),
                                   [](bool down) { return down; });
  return context.host->events.empty() && !context.ui->keyboard.typed && !context.ui->keyboard.waits() && !pressed &&
         !context.interaction->modal && !context.interaction->drag && !context.dialogs->shown &&
         context.messages->errors.empty() &&
         !ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
}

void dispatch(Context& context, const std::vector<Event>& events, InputState before) {
  const InputState after = context.ui->input;
  drop_missing_bones(context);
  for (const Event& event : events) {
    const glm::vec2 from = before.pointer;
    before.apply(event);
    context.ui->input = before;
    if (std::holds_alternative<PointerMoved>(event)) {
      on_move(context, from, before.pointer);
    } else if (const auto* button = std::get_if<ButtonChanged>(&event)) {
      if (context.interaction->modal)
        end_modal(context.interaction, context.interaction->modal->button(context, *button));
      else button->down ? on_press(context, button->button) : on_release(context, button->button);
    } else if (const auto* wheel = std::get_if<Wheeled>(&event)) {
      on_wheel(context, *wheel);
    } else if (const auto* key = std::get_if<KeyChanged>(&event)) {
      on_key(context, *key);
    } else if (const auto* dropped = std::get_if<FilesDropped>(&event)) {
      context.project->to_open.insert(context.project->to_open.end(), dropped->paths.begin(), dropped->paths.end());
    } else if (const auto* focus = std::get_if<FocusChanged>(&event); focus && !focus->focused) {
      context.interaction->pending_press.reset();
      if (context.interaction->drag && context.interaction->drag->ended) context.interaction->drag->ended(context);
      context.interaction->drag.reset();
      if (context.interaction->modal) context.interaction->modal->cancel(context);
      context.interaction->modal.reset();
    }
  }
  context.ui->input = after;
}

}  // namespace limber::editor
