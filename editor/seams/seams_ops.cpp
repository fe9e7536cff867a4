// SPDX-License-Identifier: AGPL-3.0-or-later
// Where tissue touches without being one: looked for, shown, painted.
#include "editor/context/operator.h"
#include "editor/seams/seam_view.h"
#include "editor/ui/icons.h"

namespace limber::editor {

std::vector<Operator> seam_operators() {
  return {
      {"skin.find_seams", "Find seams", icon::kSearch, "Weights",
       "Looks anew for where limbs touch without being one; seams that were changed by hand are dropped.",
       find_seams_again, why_no_seams},
      {"skin.seam_brush", "Seam brush", icon::kSeam, "Brush",
       "Strokes cut seams, as deep as the brush's radius; with Ctrl they erase them. Any other brush goes back to "
       "weights.",
       [](Editor& e) { e.seams->brush = !e.seams->brush, e.seams->shown |= e.seams->brush; },
       [](const Editor& e) {
         return e.workspace == Workspace::Skin ? std::string() : std::string("Works in the Skin workspace");
       },
       [](const Editor& e) { return e.seams->brush; }},
      {"skin.show_seams", "Show seams", icon::kVisible, "Weights", "Shows seams over the views of the Skin workspace.",
       [](Editor& e) { e.seams->shown = !e.seams->shown; }, nullptr, [](const Editor& e) { return e.seams->shown; }},
      {"skin.clear_seams", "Remove seams", icon::kTrash, "Weights", "Takes all seams away: what touches is one.",
       clear_seams,
       [](const Editor& e) {
         const auto seams = shown_seams(e);
         return !e.document().volume                      ? "Open a volume first"
                : seams && (!*seams || (*seams)->empty()) ? "There are no seams"
                                                          : "";
       }},
  };
}

}  // namespace limber::editor
