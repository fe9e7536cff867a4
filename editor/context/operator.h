// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators. An operator is one command of the user, such as "Frame all". Menus, keys, the search, buttons, scripts and
// tests all run operators. An operator that cannot run now returns the reason, which its tool tip shows to the user.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace limber::editor {

struct Editor;

struct Operator {
  std::string id;           // "view.frame_all"
  std::string label;        // "Frame all"; ends in "..." if a dialog opens
  const char* icon = "";    // one of icons.h
  std::string category;     // the menu it belongs to, which the search shows: "View"
  std::string description;  // what it does, for its tool tip
  std::function<void(Editor&)> run;
  std::function<std::string(const Editor&)> disabled_reason;  // why it cannot run; "" or no function: it can
  std::function<bool(const Editor&)> checked;                 // true if the operator is a switch that is on now
};

// Returns all operators, in the order of the menus.
std::vector<Operator> gather_operators();

const Operator* find_operator(const Editor& editor, std::string_view id);  // nullptr for none
std::string disabled_reason(const Editor& editor, const Operator& op);     // "" when it can run
// Runs the operator. If it cannot run now, shows a message with the reason instead.
void run(Editor& editor, const Operator& op);
void run(Editor& editor, std::string_view id);
// Returns true if the operator needs the pointer: it is bound to mouse buttons or the wheel, and to no key.
bool needs_pointer(const Editor& editor, const Operator& op);
// Calls `act`. If `act` throws an exception, shows it as an error message. All operators are run by this function, and
// so is their later work, such as the answer to a question, a selected file or a task's end.
bool attempt(Editor& editor, const std::string& label,
             const std::function<void(Editor&)>& act);  // returns true when nothing was thrown

}  // namespace limber::editor
