// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/workspace.h"
#include "editor/rig/bone_table.h"
#include "editor/ui/icons.h"

namespace limber::editor {

std::vector<Operator> bone_table_operators() {
  return {
      {"rig.colour_bones", "Colour by rig bone", icon::kTissues, "Rig",
       "Colour bone tissue in the views by the rig bone that it follows.",
       [](Context& c) { c.bone_table->coloured = !c.bone_table->coloured; },
       [](const Context& c) {
         return c.workspace() != Workspace::Rig ? std::string("Switch to the Rig workspace first")
                                                : why_no_bone_table(c.document());
       },
       [](const Context& c) { return c.bone_table->coloured; }},
      {"rig.clear_bone_map", "Clear bone map", icon::kTrash, "Rig",
       "Remove all assignments of bone tissue to rig bones that were made by hand.", clear_bone_map,
       [](const Context& c) {
         return c.document().bone_map ? std::string() : std::string("No bone tissue was assigned by hand");
       }},
  };
}

}  // namespace limber::editor
