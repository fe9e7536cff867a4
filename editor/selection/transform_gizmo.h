// SPDX-License-Identifier: AGPL-3.0-or-later
// What the tool of the strip lets one take hold of at the active bone: rings to turn it, arrows to move it.
//   rotate  three rings about the axes of the chosen space, a ring about the line of sight, a trackball inside
//   move    three arrows, the squares of the planes across them, a circle for the plane of the view
// Of several that lie under the pointer: the ring that is nearest to the eye, the view's ring, the trackball.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "editor/context/editor.h"
#include "editor/context/view_projection.h"

namespace limber::editor {

struct GizmoPart {
  enum class Kind { Ring, ViewRing, Trackball, Arrow, Plane, Centre };
  Kind kind = Kind::Ring;
  int axis = -1;  // of a ring or arrow; the one across a plane

  bool operator==(const GizmoPart&) const = default;
};

struct Gizmo {
  Tool tool = Tool::Rotate;  // Rotate, Move or Scale
  glm::dvec3 centre{0};
  glm::dmat3 axes{1};  // columns; unit
};

// Of the tool in use, where it stands in that view; nothing where it takes hold of nothing.
std::optional<Gizmo> gizmo_in(const Editor& editor, const ViewProjection& view);
// What of it lies under the pixel.
std::optional<GizmoPart> part_at(const Gizmo& gizmo, const ViewProjection& view, float scale, const glm::dvec2& pixel);

// That bone alone.
void choose_bone(Editor& editor, int bone);

// In the Rig workspace: chooses the joint or bone under the pointer, in any view; false where there is none.
bool pick_bone_part(Editor& editor);

// The bone under the pointer in the 3D view, in the Pose workspace in any.
std::optional<int> bone_at_pointer(const Editor& editor);

// The bones under the pointer, in any view: how far they lie before the 3D view's eye, or from the slice, mm.
std::vector<std::pair<double, int>> bones_below(const Editor& editor);

// Begins a tool when the pointer is over a part, or over a joint that the reach tool drags; false when it is over none.
bool press_gizmo(Editor& editor);
// Over a view, after its picture.
void draw_gizmo(Editor& editor, const ViewPlace& place);

}  // namespace limber::editor
