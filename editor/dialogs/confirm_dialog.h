// SPDX-License-Identifier: AGPL-3.0-or-later
// A dialog that asks a question. It has a title, one or two lines of text, and a button for each answer at the lower
// right. The button of the recommended answer is the last one.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace limber::editor {

struct Context;

struct Answer {
  std::string label;
  std::function<void(Context&)> act;  // called when the user selects the answer; empty: nothing happens
  bool primary = false;               // true: the key Return selects this answer
};

struct Question {
  std::string title;
  std::vector<std::string> lines;
  const char* icon = "";
  std::vector<Answer> answers;  // the buttons from left to right; Escape closes the dialog without an answer
};

void ask(Context& context, Question question);

}  // namespace limber::editor
