// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/icons.h"
#include "editor/operators/polls.h"

namespace limber::editor {

std::vector<Operator> file_operators() {
  return {
      {"file.quit", "Quit", icon::kClose, "File", "Ends the editor.", [](Editor& e) { e.quit = true; }},
  };
}

}  // namespace limber::editor
