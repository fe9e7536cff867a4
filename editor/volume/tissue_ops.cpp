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

// The tissues an operator works on: those chosen, else the one under the pointer.
std::set<Label> chosen(const Editor& editor) {
  if (!editor.selection.tissues.empty()) return editor.selection.tissues;
  if (editor.views->hover.inside) return {editor.views->hover.label};
  return {};
}

std::string needs_chosen(const Editor& editor) {
  if (!editor.document().volume) return "Open a volume first";
  return chosen(editor).empty() ? "Choose a tissue, or point at one" : "";
}

// Only the chosen tissues, filling the view; once more: all again.
void isolate(Editor& editor) {
  solo_tissues(editor, chosen(editor));
  run(editor, any_hidden(editor) ? "view.frame_selected" : "view.frame_all");
}

}  // namespace

std::vector<Operator> tissue_operators() {
  return {
      {"view.hide", "Hide", icon::kHidden, "View", "Hides the chosen tissues.",
       [](Editor& e) { show_tissues(e, chosen(e), false); }, needs_chosen},
      {"view.isolate_selected", "Show only", icon::kVisible, "View", "Hides every tissue but the chosen ones.",
       [](Editor& e) { solo_tissues(e, chosen(e)); }, needs_chosen},
      {"view.isolate", "Isolate", icon::kVisible, "View",
       "Shows only the chosen tissues and brings them to fill the view, or brings all back.", isolate, needs_tissue},
      {"view.reveal", "Reveal all", icon::kVisible, "View", "Shows every hidden tissue again.",
       [](Editor& e) { reveal_tissues(e); },
       [](const Editor& e) { return any_hidden(e) ? std::string() : std::string("Nothing is hidden"); }},
  };
}

}  // namespace limber::editor
