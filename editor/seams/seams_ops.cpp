// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that find, show, edit and remove seams: voxel faces at which two body parts touch without being joined.
#include "editor/context/operator.h"
#include "editor/seams/seam_view.h"
#include "editor/ui/icons.h"

namespace limber::editor {

std::vector<Operator> seam_operators() {
  return {
      {"skin.find_seams", "Find seams", icon::kSearch, "Weights",
       "Find the seams: voxel faces where limbs touch but are not connected. Discards the seams that you cut or erased "
       "by hand.",
       find_seams_again, why_no_seams},
      {"skin.seam_brush", "Seam brush", icon::kSeam, "Brush",
       "Cut a seam with a stroke, as deep as the brush's radius. Hold Ctrl to erase seams. Select any other brush to "
       "paint weights again.",
       [](Editor& e) { e.seams->brush = !e.seams->brush, e.seams->shown |= e.seams->brush; },
       [](const Editor& e) {
         return e.workspace == Workspace::Skin ? std::string() : std::string("Switch to the Skin workspace first");
       },
       [](const Editor& e) { return e.seams->brush; }},
      {"skin.show_seams", "Show seams", icon::kVisible, "Weights",
       "Show or hide the seams in the views of the Skin workspace.",
       [](Editor& e) { e.seams->shown = !e.seams->shown; }, nullptr, [](const Editor& e) { return e.seams->shown; }},
      {"skin.clear_seams", "Remove seams", icon::kTrash, "Weights",
       "Remove all seams, so that limbs that touch are treated as connected.", clear_seams,
       [](const Editor& e) {
         const auto seams = shown_seams(e);
         return !e.document().volume                      ? "Open a volume first"
                : seams && (!*seams || (*seams)->empty()) ? "There are no seams"
                                                          : "";
       }},
  };
}

}  // namespace limber::editor
