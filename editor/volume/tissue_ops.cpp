// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/volume/tissue_edits.h"

#include "editor/context/operator_polls.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

bool any_hidden(const Document& document) {
  if (!document.visibility) return false;
  for (const auto& [label, look] : document.visibility->looks)
    if (!look.visible) return true;
  return false;
}

// Returns the tissues that an operator works on: the selected tissues or, if none is selected, the tissue under the
// pointer.
std::set<Label> chosen(const Context& context) {
  if (!context.selection->tissues.empty()) return context.selection->tissues;
  if (context.views->hover.inside) return {context.views->hover.label};
  return {};
}

std::string needs_chosen(const Context& context) {
  if (!context.document().volume) return "Open a volume first";
  return chosen(context).empty() ? "Select a tissue, or point at one" : "";
}

// Shows only the selected tissues and zooms the view to them. A second call shows all tissues again.
void isolate(Context& context) {
  solo_tissues(context, chosen(context));
  run(context, any_hidden(context.document()) ? "view.frame_selected" : "view.frame_all");
}

}  // namespace

std::vector<Operator> tissue_operators() {
  return {
      {"view.hide", "Hide", icon::kHidden, "View", "Hide the selected tissues.",
       [](Context& c) { show_tissues(c, chosen(c), false); }, needs_chosen},
      {"view.isolate_selected", "Show only", icon::kVisible, "View", "Hide every tissue except the selected ones.",
       [](Context& c) { solo_tissues(c, chosen(c)); }, needs_chosen},
      {"view.isolate", "Isolate", icon::kVisible, "View",
       "Show only the selected tissues and zoom the view to them. Run again to show all.", isolate, needs_tissue},
      {"view.reveal", "Reveal all", icon::kVisible, "View", "Show every hidden tissue again.",
       [](Context& c) { reveal_tissues(c); },
       [](const Context& c) { return any_hidden(c.document()) ? std::string() : std::string("Nothing is hidden"); }},
  };
}

}  // namespace limber::editor
