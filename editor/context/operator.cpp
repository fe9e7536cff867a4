// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"

#include <algorithm>
#include <filesystem>
#include <new>

#include "core/base/error.h"
#include "editor/context/context.h"
#include "editor/context/operator_registry.h"
#include "editor/context/preferences.h"
#include "editor/input/keymap.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

namespace {

// Records that an operator was used. The command Repeat runs the last operator again, and the search lists the latest
// and the most used operators first.
void note_use(Context& context, const Operator& op) {
  if (op.id == "search.commands" || op.id == "edit.repeat_last" || op.id == "edit.adjust_last" ||
      needs_pointer(context.keymap, op))
    return;
  context.operators->last = op.id;
  auto& recent = context.preferences->recent_commands;
  std::erase(recent, op.id);
  recent.insert(recent.begin(), op.id);
  if (recent.size() > Preferences::kMostRecent) recent.pop_back();
  context.preferences->command_counts[op.id] += 1;
}

// Returns true if the animation keeps playing while the operator runs: for operators that do not change the pose, such
// as those that turn a view or select.
bool goes_on_while_playing(const Operator& op) {
  constexpr const char* kSuch[] = {"view.",    "slice.",  "select.", "motion.",  "workspace.",
                                   "compare.", "search.", "help.",   "file.save"};
  return std::any_of(std::begin(kSuch), std::end(kSuch), [&](const char* such) { return op.id.starts_with(such); });
}

}  // namespace

const Operator* find_operator(const OperatorRegistry& operators, std::string_view id) {
  const auto found =
      std::find_if(operators.all.begin(), operators.all.end(), [&](const Operator& op) { return op.id == id; });
  return found == operators.all.end() ? nullptr : &*found;
}

std::string disabled_reason(const Context& context, const Operator& op) {
  return op.disabled_reason ? op.disabled_reason(context) : "";
}

bool attempt(Context& context, const std::string& label, const std::function<void(Context&)>& act) {
  try {
    act(context);
    return true;
  } catch (const Cancelled&) {
  } catch (const Error& error) {
    context.messages->show_error(error.what(), label);
  } catch (const std::bad_alloc&) {
    context.messages->show_error("There is not enough memory: " + label +
                                 ": close other programs, or use a coarser volume");
  } catch (const std::filesystem::filesystem_error& error) {
    context.messages->show_error(error.code().message() + ": " + error.path1().string() +
                                     ": check the name, and your permission to read and write there",
                                 label);
  } catch (const std::exception& error) {
    context.messages->show_error(std::string("Internal error: ") + label + ": " + error.what());
  }
  return false;
}

// Shows a message that says why an operator cannot run now. If the operator belongs to another workspace, the message
// has a button that opens that workspace.
static void tell_why_not(Messages& messages, const Operator& op, const std::string& reason) {
  messages.info(op.label, reason);
  for (const auto& [name, id] : {std::pair("Rig", "workspace.rig"),
                                 {"Skin", "workspace.skin"},
                                 {"Pose", "workspace.pose"},
                                 {"Resample", "workspace.resample"}}) {
    if (!reason.starts_with(std::string("Switch to the ") + name)) continue;
    for (Toast& toast : messages.toasts)
      if (toast.line == op.label && toast.detail == reason) toast.action = id;
  }
}

void run(Context& context, const Operator& op) {
  context.ui->touch();
  if (const std::string reason = disabled_reason(context, op); !reason.empty())
    return tell_why_not(context.messages, op, reason);
  if (!goes_on_while_playing(op)) context.operators->before_change(context);
  if (attempt(context, op.label, op.run)) note_use(context, op);
}

bool needs_pointer(const Keymap& keymap, const Operator& op) {
  bool any = false;
  for (const auto& [key_context, bindings] : keymap.contexts)
    for (const Binding& binding : bindings) {
      if (binding.operator_id != op.id) continue;
      if (binding.chord.kind == Chord::Kind::Key) return false;
      any = true;
    }
  return any;
}

void run(Context& context, std::string_view id) {
  if (const Operator* op = find_operator(context.operators, id)) run(context, *op);
}

}  // namespace limber::editor
