// SPDX-License-Identifier: AGPL-3.0-or-later
// Everything a user can do, as a value: menus, keys, the search, buttons, scripts and tests all go through these. An
// operator that cannot run now says why, in the user's words; the sentence is its tool tip.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace limber::editor {

struct Editor;

struct Operator {
  std::string id;           // "view.frame_all"
  std::string label;        // "Frame all"; ends in "..." when it asks for more
  const char* icon = "";    // of icons.h
  std::string category;     // the menu it belongs to, as the search shows it: "View"
  std::string description;  // what it does
  std::function<void(Editor&)> run;
  std::function<std::string(const Editor&)> disabled_reason;  // why it cannot run; "" or no function: it can
  std::function<bool(const Editor&)> checked;                 // switches: whether it is on
};

// All operators, in the order of the menus.
std::vector<Operator> gather_operators();

const Operator* find_operator(const Editor& editor, std::string_view id);  // nullptr for none
std::string disabled_reason(const Editor& editor, const Operator& op);     // "" when it can run
// Runs it, or says why not.
void run(Editor& editor, const Operator& op);
void run(Editor& editor, std::string_view id);
// Whether it is for the pointer alone: its keys are buttons and wheels, and it means nothing away from them.
bool needs_pointer(const Editor& editor, const Operator& op);
// What follows an operator: an answer given, a file chosen, a task's end. What is thrown becomes a message: the only
// place of the editor that catches.
bool attempt(Editor& editor, const std::string& label,
             const std::function<void(Editor&)>& act);  // true when nothing was thrown

}  // namespace limber::editor
