// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators. An operator is one command of the user, such as "Frame all". Menus, keys, the search, buttons, scripts and
// tests all run operators. An operator that cannot run now returns the reason, which its tool tip shows to the user.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace limber::editor {

struct Context;
struct Keymap;
struct OperatorRegistry;

struct Operator {
  std::string id;           // unique name of the operator, such as "view.frame_all"
  std::string label;        // text in menus, such as "Frame all"; ends in "..." if the operator opens a dialog
  const char* icon = "";    // icon, one of the constants in icons.h; "": the operator has no icon
  std::string category;     // the menu that the operator belongs to, such as "View"; the search shows it
  std::string description;  // text of the tool tip: what the operator does
  std::function<void(Context&)> run;
  // Returns why the operator cannot run now; "" or no function: it can run.
  std::function<std::string(const Context&)> disabled_reason;
  // Returns true if the operator is a switch and is on now; empty: it is no switch.
  std::function<bool(const Context&)> checked;
};

// Returns all operators, in the order of the menus.
std::vector<Operator> gather_operators();

// Returns the operator with this id; nullptr if there is none.
const Operator* find_operator(const OperatorRegistry& operators, std::string_view id);
// Returns why the operator cannot run now; "" if it can.
std::string disabled_reason(const Context& context, const Operator& op);
// Runs the operator. If it cannot run now, shows a message with the reason instead.
void run(Context& context, const Operator& op);
void run(Context& context, std::string_view id);
// Returns true if the operator needs the pointer: it is bound to mouse buttons or the wheel, and to no key.
bool needs_pointer(const Keymap& keymap, const Operator& op);
// Calls `act` and returns true. If `act` throws an exception, shows it as an error message and returns false. All
// operators are run by this function, and so is their later work, such as the answer to a question, a selected file or
// a task's end.
bool attempt(Context& context, const std::string& label, const std::function<void(Context&)>& act);

}  // namespace limber::editor
