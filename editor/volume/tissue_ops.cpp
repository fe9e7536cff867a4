// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/volume/tissue_edits.h"

#include "editor/context/operator_polls.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

bool any_hidden(const Editor& editor) {
  if (!editor.document().visibility) return false;
  for (const auto& [label, look] : editor.document().visibility->looks)
    if (!look.visible) return true;
  return false;
}

// Returns the tissues that an operator works on: the selected tissues or, if none is selected, the tissue under the
// pointer.
std::set<Label> chosen(const Editor& editor) {
  if (!editor.selection.tissues.empty()) return editor.selection.tissues;
  if (editor.views->hover.inside) return {editor.views->hover.label};
  return {};
}

std::string needs_chosen(const Editor& editor) {
  if (!editor.document().volume) return "Open a volume first";
  return chosen(editor).empty() ? "Select a tissue, or point at one" : "";
}

// Shows only the selected tissues and zooms the view to them. A second call shows all tissues again.
void isolate(Editor& editor) {
  solo_tissues(editor, chosen(editor));
  run(editor, any_hidden(editor) ? "view.frame_selected" : "view.frame_all");
}

}  // namespace

std::vector<Operator> tissue_operators() {
  return {
      {"view.hide", "Hide", icon::kHidden, "View", "Hide the selected tissues.",
       [](Editor& e) { show_tissues(e, chosen(e), false); }, needs_chosen},
      {"view.isolate_selected", "Show only", icon::kVisible, "View", "Hide every tissue except the selected ones.",
       [](Editor& e) { solo_tissues(e, chosen(e)); }, needs_chosen},
      {"view.isolate", "Isolate", icon::kVisible, "View",
       "Show only the selected tissues and zoom the view to them. Run again to show all.", isolate, needs_tissue},
      {"view.reveal", "Reveal all", icon::kVisible, "View", "Show every hidden tissue again.",
       [](Editor& e) { reveal_tissues(e); },
       [](const Editor& e) { return any_hidden(e) ? std::string() : std::string("Nothing is hidden"); }},
  };
}

}  // namespace limber::editor
