// SPDX-License-Identifier: AGPL-3.0-or-later
// A question after the user's own act: a title, a line or two, answers at the right, the best one last.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "editor/context/editor.h"

namespace limber::editor {

struct Answer {
  std::string label;
  std::function<void(Editor&)> act;  // empty: nothing is done
  bool primary = false;              // Return chooses it
};

struct Question {
  std::string title;
  std::vector<std::string> lines;
  const char* icon = "";
  std::vector<Answer> answers;  // Escape means the first, when that does nothing; else it closes the question alone
};

void ask(Editor& editor, Question question);

}  // namespace limber::editor
