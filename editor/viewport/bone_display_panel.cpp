// SPDX-License-Identifier: AGPL-3.0-or-later
// Draws the section "Display" of the Rig and Pose workspaces, in which the user sets how bones are drawn.
#include <array>

#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/widgets.h"

namespace limber::editor {

namespace {

// The operators that select a bone shape, in the order of BoneShape.
constexpr std::array<const char*, 3> kShapes = {"view.bones_octahedron", "view.bones_stick", "view.bones_cylinder"};

}  // namespace

void draw_display(Editor& editor, Column& column) {
  if (!editor.document().armature || (editor.workspace != Workspace::Rig && editor.workspace != Workspace::Pose))
    return;
  if (column.begin_section("Display", "", false)) {
    column.space(6);
    std::vector<std::string> shapes;
    for (const char* id : kShapes) shapes.push_back(find_operator(editor, id)->label);
    int shape = static_cast<int>(editor.views->bone_shape);
    const Rect field = column.property("Bones");
    {
      const PathScope scope(editor, "Bones");
      if (choice_field(editor, field, shapes, shape)) run(editor, kShapes[shape]);
    }
    operator_box(editor, "view.bone_names", column.property(""), "Names");
    operator_box(editor, "view.bone_axes", column.property(""), "Axes");
    operator_box(editor, "view.bones_in_front", column.property(""), "In front");
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
