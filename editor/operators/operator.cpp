// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/operators/operator.h"

#include <algorithm>
#include <new>

#include "core/base/error.h"
#include "editor/editor.h"

namespace limber::editor {

std::vector<Operator> gather_operators() {
  std::vector<Operator> all;
  for (auto list : {file_operators, edit_operators, workspace_operators, view_operators, navigation_operators, clip_operators, slice_operators,
                    tissue_operators, select_operators})
    for (Operator& op : list()) all.push_back(std::move(op));
  return all;
}

const Operator* find_operator(const Editor& editor, std::string_view id) {
  const auto found = std::find_if(editor.operators.begin(), editor.operators.end(), [&](const Operator& op) { return op.id == id; });
  return found == editor.operators.end() ? nullptr : &*found;
}

std::string why_not(const Editor& editor, const Operator& op) { return op.why_not ? op.why_not(editor) : ""; }

void run(Editor& editor, const Operator& op) {
  editor.touch();
  if (const std::string reason = why_not(editor, op); !reason.empty()) return editor.messages.info(op.label, reason);
  try {
    op.run(editor);
  } catch (const Cancelled&) {
  } catch (const Error& error) {
    editor.messages.show_error(error.what());
  } catch (const std::bad_alloc&) {
    editor.messages.show_error("There is not enough memory: " + op.label + ": close something, or use a coarser volume");
  } catch (const std::exception& error) {
    editor.messages.show_error(std::string("A mistake of the program itself: ") + op.label + ": " + error.what());
  }
}

void run(Editor& editor, std::string_view id) {
  if (const Operator* op = find_operator(editor, id)) run(editor, *op);
}

}  // namespace limber::editor
