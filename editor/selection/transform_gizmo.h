// SPDX-License-Identifier: AGPL-3.0-or-later
// The gizmo that is drawn at the active bone. Its parts depend on the tool that is selected in the tool strip:
//   rotate  three rings about the axes of the selected space, a ring about the line of sight, a trackball inside them
//   move    three arrows, three squares that each move in a plane of two axes, a circle that moves in the view's plane
//   scale   three arrows with boxes, a circle that scales along all axes
// When several parts lie under the pointer, the axis ring nearest to the eye is hit first, then the ring about the line
// of sight, then the trackball. The file also finds and draws bones, pins, poles and joint limits over the views.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "editor/context/tool.h"
#include "editor/ui/rect.h"

namespace limber::editor {

struct Context;
struct ViewPlace;
struct ViewProjection;

struct GizmoPart {
  enum class Kind { Ring, ViewRing, Trackball, Arrow, Plane, Centre };
  Kind kind = Kind::Ring;
  int axis = -1;  // axis of the ring or arrow, or of the plane's normal, 0 to 2; -1: the part has no axis

  bool operator==(const GizmoPart&) const = default;
};

struct Gizmo {
  Tool tool = Tool::Rotate;  // the tool that the gizmo is for: Rotate, Move or Scale
  glm::dvec3 centre{0};      // position of the gizmo in the world, mm
  glm::dmat3 axes{1};        // the gizmo's axes as columns, unit vectors
};

// Returns the gizmo that the selected tool shows in a view; nothing when it shows none.
std::optional<Gizmo> gizmo_in(const Context& context, const ViewProjection& view);
// Returns the rectangle that the gizmo covers in a view, pixels; nothing when there is none.
std::optional<Rect> gizmo_rect(const Context& context, const ViewProjection& view);
// Returns the part of the gizmo under the pixel; nothing when there is none.
//   scale  scale of the interface, 1: 100 %
std::optional<GizmoPart> part_at(const Gizmo& gizmo, const ViewProjection& view, float scale, const glm::dvec2& pixel);

// Selects this bone, makes it the active bone, and deselects all other bones and all tissues.
void choose_bone(Context& context, int bone);

// Selects the joint or bone under the pointer, in any view of the Rig workspace. Returns false in other workspaces, or
// if no joint or bone is under the pointer.
bool pick_bone_part(Context& context);

// Returns the bone under the pointer; nothing if there is none. In slices, finds bones only in the Pose workspace.
std::optional<int> bone_at_pointer(const Context& context);

// Returns all bones under the pointer, each with a distance in mm. In the 3D view this is the distance from the eye, in
// a slice the distance from the slice's plane.
std::vector<std::pair<double, int>> bones_below(const Context& context);

// Begins to drag the pole (the point towards which a limb's elbow or knee points), joint handle, part of the gizmo,
// joint or bone under the pointer. Returns false if the pointer is on nothing that the selected tool can drag.
bool press_gizmo(Context& context);
// Draws the gizmo, bone names, pinned joints, poles, joint limits and the marks of the rig check over a view.
void draw_gizmo(Context& context, const ViewPlace& place);

}  // namespace limber::editor
