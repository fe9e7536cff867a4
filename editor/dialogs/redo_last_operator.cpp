// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/dialogs/redo_last_operator.h"

namespace limber::editor {

void act_and_allow_redo(Editor& editor, const std::vector<FormField>& fields, const ActWith& act,
                        const std::function<void(Editor&)>& first) {
  LastOperation done{.fields = fields,
                     .shown = fields,
                     .act = act,
                     .selection = editor.selection,
                     .part = editor.transform_settings->part,
                     .unfolded = editor.last_operation->unfolded};
  const History& history = editor.history;
  const std::int64_t before = history.revision();
  if (first) first(editor);
  else act(editor, fields);
  if (history.revision() == before) return;
  const std::int64_t position = history.position();
  const bool one_step = position > 0 && history.steps()[position - 1].revision == before;
  done.label = one_step && !fields.empty() ? history.steps()[position].label : "";
  done.revision = history.revision();
  *editor.last_operation = std::move(done);
}

std::string why_not_redo(const Editor& editor) {
  const LastOperation& last = *editor.last_operation;
  if (editor.modal) return "Finish or cancel the active tool first";
  if (!last.label.empty() && last.revision == editor.history.revision()) return "";
  if (editor.history.position() == 0) return "Nothing has been done yet";
  return editor.history.steps()[editor.history.position()].label + " has nothing to adjust";
}

void redo_last_operator(Editor& editor, const std::vector<FormField>& fields) {
  if (const std::string why = why_not_redo(editor); !why.empty())
    return editor.messages.info("Adjust last operation", why);
  LastOperation& last = *editor.last_operation;
  const Selection selection = editor.selection;
  const bool taken_back = last.made_a_step && editor.history.undo();
  editor.selection = last.selection;
  editor.transform_settings->part = last.part;
  const std::int64_t before = editor.history.revision();
  editor.touch();
  if (!attempt(editor, last.label, [&](Editor& e) { last.act(e, fields); })) {
    if (taken_back) editor.history.redo();
    editor.selection = selection;
    last.shown = last.fields;
    return;
  }
  last.fields = last.shown = fields;
  last.revision = editor.history.revision();
  last.made_a_step = last.revision != before;
}

}  // namespace limber::editor
