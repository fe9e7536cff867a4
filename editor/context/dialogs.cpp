// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/dialogs.h"

#include <utility>

#include "editor/context/context.h"
#include "editor/ui/keyboard.h"
#include "editor/ui/ui.h"

namespace limber::editor {

void Dialog::escape(Context& context) { context.dialogs->close(); }

void Dialogs::open(std::unique_ptr<Dialog> dialog) {
  if (!of_users_act) return waiting.push_back(std::move(dialog));
  next = std::move(dialog);
  await_field(ui);
}

void Dialogs::close() { next = std::unique_ptr<Dialog>(); }

void Dialogs::change() {
  if (!next) return;
  shown = std::move(*next);
  next.reset();
  ui.touch();
}

}  // namespace limber::editor
