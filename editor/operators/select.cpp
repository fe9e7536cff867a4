// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/icons.h"
#include "editor/operators/polls.h"
#include "editor/tissues.h"

namespace limber::editor {

namespace {

void pick(Editor& editor) {
  if (editor.tool == Tool::CrossHair) return run(editor, "view.place_cross_hair");
  const Hover& hover = editor.views->hover;
  if (hover.inside) select_tissue(editor, hover.label, false);
  else editor.selection = {};
}

void extend(Editor& editor) {
  if (editor.views->hover.inside) select_tissue(editor, editor.views->hover.label, true);
}

Operator tool_operator(const char* id, const char* label, const char* icon, const char* sentence, Tool tool) {
  return {id, label, icon, "Tool", sentence, [tool](Editor& e) { e.tool = tool; }, nullptr, [tool](const Editor& e) { return e.tool == tool; }};
}

}  // namespace

std::vector<Operator> select_operators() {
  return {
      {"select.pick", "Select", icon::kSelect, "Select", "Chooses the tissue under the pointer.", pick, needs_volume},
      {"select.extend", "Extend selection", "", "Select", "Adds the tissue under the pointer to the chosen ones, or takes it out.", extend, needs_volume},
      {"select.none", "Select nothing", "", "Select", "Chooses nothing.", [](Editor& e) { e.selection = {}; }},
      {"select.all", "Select all", "", "Select", "Chooses every tissue.",
       [](Editor& e) {
         for (const Tissue& tissue : e.document().tissues->tissues) e.selection.tissues.insert(tissue.label);
       },
       needs_volume},
      tool_operator("tool.select", "Select", icon::kSelect, "A click chooses the tissue under the pointer.", Tool::Select),
      tool_operator("tool.cross_hair", "Cross-hair", icon::kCrossHair, "A click moves the cross-hair, and the slices with it.", Tool::CrossHair),
  };
}

}  // namespace limber::editor
