// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/operator.h"
#include "editor/rig/bone_table.h"
#include "editor/ui/icons.h"

namespace limber::editor {

std::vector<Operator> bone_table_operators() {
  return {
      {"rig.colour_bones", "Colour by rig bone", icon::kTissues, "Rig",
       "Colour bone tissue in the views by the rig bone that it follows.",
       [](Editor& e) { e.bone_table->coloured = !e.bone_table->coloured; },
       [](const Editor& e) {
         return e.workspace != Workspace::Rig ? std::string("Switch to the Rig workspace first") : why_no_bone_table(e);
       },
       [](const Editor& e) { return e.bone_table->coloured; }},
      {"rig.clear_bone_map", "Clear bone map", icon::kTrash, "Rig",
       "Remove all assignments of bone tissue to rig bones that were made by hand.", clear_bone_map,
       [](const Editor& e) {
         return e.document().bone_map ? std::string() : std::string("No bone tissue was assigned by hand");
       }},
  };
}

}  // namespace limber::editor
