// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/dialogs/redo_last_operator.h"

#include "core/project/history.h"
#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/operator.h"
#include "editor/ui/messages.h"
#include "editor/ui/ui.h"

namespace limber::editor {

void act_and_allow_redo(Context& context, const std::vector<FormField>& fields, const ActWith& act,
                        const std::function<void(Context&)>& first) {
  LastOperation done{.fields = fields,
                     .shown = fields,
                     .act = act,
                     .selection = context.selection,
                     .part = context.transform_settings->part,
                     .unfolded = context.last_operation->unfolded};
  const History& history = context.history;
  const std::int64_t before = history.revision();
  if (first) first(context);
  else act(context, fields);
  if (history.revision() == before) return;
  const std::int64_t position = history.position();
  const bool one_step = position > 0 && history.steps()[position - 1].revision == before;
  done.label = one_step && !fields.empty() ? history.steps()[position].label : "";
  done.revision = history.revision();
  *context.last_operation = std::move(done);
}

std::string why_not_redo(const Context& context) {
  const LastOperation& last = *context.last_operation;
  if (context.interaction->modal) return "Finish or cancel the active tool first";
  if (!last.label.empty() && last.revision == context.history->revision()) return "";
  if (context.history->position() == 0) return "Nothing has been done yet";
  return context.history->steps()[context.history->position()].label + " has no settings to adjust";
}

void redo_last_operator(Context& context, const std::vector<FormField>& fields) {
  if (const std::string why = why_not_redo(context); !why.empty())
    return context.messages->info("Adjust last operation", why);
  LastOperation& last = *context.last_operation;
  const Selection selection = context.selection;
  const bool taken_back = last.made_a_step && context.history->undo();
  *context.selection = last.selection;
  context.transform_settings->part = last.part;
  const std::int64_t before = context.history->revision();
  context.ui->touch();
  if (!attempt(context, last.label, [&](Context& c) { last.act(c, fields); })) {
    if (taken_back) context.history->redo();
    *context.selection = selection;
    last.shown = last.fields;
    return;
  }
  last.fields = last.shown = fields;
  last.revision = context.history->revision();
  last.made_a_step = last.revision != before;
}

}  // namespace limber::editor
