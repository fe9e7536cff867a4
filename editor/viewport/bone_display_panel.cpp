// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the section "Display" of the Rig and Pose workspaces, in which the user sets how bones are drawn.
#include <array>

#include "editor/context/context.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/widgets.h"

namespace limber::editor {

namespace {

// The operators that select a bone shape, in the order of BoneShape.
constexpr std::array<const char*, 3> kShapes = {"view.bones_octahedron", "view.bones_stick", "view.bones_cylinder"};

}  // namespace

void draw_display(Context& context, Column& column) {
  if (!context.document().armature || (context.workspace() != Workspace::Rig && context.workspace() != Workspace::Pose))
    return;
  if (column.begin_section("Display", "", false)) {
    column.space(6);
    std::vector<std::string> shapes;
    for (const char* id : kShapes) shapes.push_back(find_operator(context.operators, id)->label);
    int shape = static_cast<int>(context.views->bone_shape);
    const Rect field = column.property("Bones");
    {
      const PathScope scope(context.ui, "Bones");
      if (choice_field(context.ui, field, shapes, shape)) run(context, kShapes[shape]);
    }
    operator_box(context, "view.bone_names", column.property(""), "Names");
    operator_box(context, "view.bone_axes", column.property(""), "Axes");
    operator_box(context, "view.bones_in_front", column.property(""), "In front");
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
