// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"

#include <algorithm>
#include <filesystem>
#include <new>

#include "core/base/error.h"
#include "editor/context/editor.h"

namespace limber::editor {

namespace {

// Records that an operator was used. The command Repeat runs the last operator again, and the search lists the latest
// and the most used operators first.
void note_use(Editor& editor, const Operator& op) {
  if (op.id == "search.commands" || op.id == "edit.repeat_last" || op.id == "edit.adjust_last" ||
      needs_pointer(editor, op))
    return;
  editor.last_operator = op.id;
  auto& recent = editor.preferences.recent_commands;
  std::erase(recent, op.id);
  recent.insert(recent.begin(), op.id);
  if (recent.size() > Preferences::kMostRecent) recent.pop_back();
  editor.preferences.command_counts[op.id] += 1;
}

// Returns true if the animation keeps playing while the operator runs: for operators that do not change the pose, such
// as those that turn a view or select.
bool goes_on_while_playing(const Operator& op) {
  constexpr const char* kSuch[] = {"view.",    "slice.",  "select.", "motion.",  "workspace.",
                                   "compare.", "search.", "help.",   "file.save"};
  return std::any_of(std::begin(kSuch), std::end(kSuch), [&](const char* such) { return op.id.starts_with(such); });
}

}  // namespace

const Operator* find_operator(const Editor& editor, std::string_view id) {
  const auto found =
      std::find_if(editor.operators.begin(), editor.operators.end(), [&](const Operator& op) { return op.id == id; });
  return found == editor.operators.end() ? nullptr : &*found;
}

std::string disabled_reason(const Editor& editor, const Operator& op) {
  return op.disabled_reason ? op.disabled_reason(editor) : "";
}

bool attempt(Editor& editor, const std::string& label, const std::function<void(Editor&)>& act) {
  try {
    act(editor);
    return true;
  } catch (const Cancelled&) {
  } catch (const Error& error) {
    editor.messages.show_error(error.what(), label);
  } catch (const std::bad_alloc&) {
    editor.messages.show_error("There is not enough memory: " + label +
                               ": close other programs, or use a coarser volume");
  } catch (const std::filesystem::filesystem_error& error) {
    editor.messages.show_error(error.code().message() + ": " + error.path1().string() +
                                   ": check the name, and your permission to read and write there",
                               label);
  } catch (const std::exception& error) {
    editor.messages.show_error(std::string("Internal error: ") + label + ": " + error.what());
  }
  return false;
}

// Shows a message that says why an operator cannot run now. If the operator belongs to another workspace, the message
// has a button that opens that workspace.
static void tell_why_not(Editor& editor, const Operator& op, const std::string& reason) {
  editor.messages.info(op.label, reason);
  for (const auto& [name, id] : {std::pair("Rig", "workspace.rig"),
                                 {"Skin", "workspace.skin"},
                                 {"Pose", "workspace.pose"},
                                 {"Resample", "workspace.resample"}}) {
    if (!reason.starts_with(std::string("Switch to the ") + name)) continue;
    for (Toast& toast : editor.messages.toasts)
      if (toast.line == op.label && toast.detail == reason) toast.action = id;
  }
}

void run(Editor& editor, const Operator& op) {
  editor.touch();
  if (const std::string reason = disabled_reason(editor, op); !reason.empty()) return tell_why_not(editor, op, reason);
  if (!goes_on_while_playing(op)) editor.before_change(editor);
  if (attempt(editor, op.label, op.run)) note_use(editor, op);
}

bool needs_pointer(const Editor& editor, const Operator& op) {
  bool any = false;
  for (const auto& [context, bindings] : editor.keymap.contexts)
    for (const Binding& binding : bindings) {
      if (binding.operator_id != op.id) continue;
      if (binding.chord.kind == Chord::Kind::Key) return false;
      any = true;
    }
  return any;
}

void run(Editor& editor, std::string_view id) {
  if (const Operator* op = find_operator(editor, id)) run(editor, *op);
}

}  // namespace limber::editor
