// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators that find, show, edit and remove seams: voxel faces at which two body parts touch without being joined.
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/workspace.h"
#include "editor/seams/seam_view.h"
#include "editor/ui/icons.h"

namespace limber::editor {

std::vector<Operator> seam_operators() {
  return {
      {"skin.find_seams", "Find seams", icon::kSearch, "Weights",
       "Find the seams: voxel faces where limbs touch but are not connected. Discards all edits of seams that "
       "you made by hand.",
       find_seams_again, why_no_seams},
      {"skin.seam_brush", "Seam brush", icon::kSeam, "Brush",
       "Cut a seam with a stroke, as deep as the brush's radius. Hold Ctrl to erase seams. Select any other brush to "
       "paint weights again.",
       [](Context& c) { c.seams->brush = !c.seams->brush, c.seams->shown |= c.seams->brush; },
       [](const Context& c) {
         return c.workspace() == Workspace::Skin ? std::string() : std::string("Switch to the Skin workspace first");
       },
       [](const Context& c) { return c.seams->brush; }},
      {"skin.show_seams", "Show seams", icon::kVisible, "Weights",
       "Show or hide the seams in the views of the Skin workspace.",
       [](Context& c) { c.seams->shown = !c.seams->shown; }, nullptr, [](const Context& c) { return c.seams->shown; }},
      {"skin.clear_seams", "Remove seams", icon::kTrash, "Weights",
       "Remove all seams, so that limbs that touch are treated as connected.", clear_seams,
       [](const Context& c) {
         const auto seams = shown_seams(c);
         return !c.document().volume                      ? "Open a volume first"
                : seams && (!*seams || (*seams)->empty()) ? "There are no seams"
                                                          : "";
       }},
  };
}

}  // namespace limber::editor
