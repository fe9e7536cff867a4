// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/constraint_overlay.h"

#include "editor/context/context.h"
#include "editor/context/selection.h"
#include "editor/context/view_projection.h"
#include "editor/context/workspace.h"
#include "editor/motion/constraint_edits.h"
#include "editor/motion/timeline.h"
#include "editor/shown/shown_pose.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

// Colour of the line of a constraint whose bone is not selected: RGB 8FBEFF with 45 % opacity, stored as ABGR.
constexpr Colour kQuiet = 0x73FFBE8F;
constexpr float kWidth = 1, kMark = 7;

glm::dvec3 middle_of(const PosedRig& rig, int bone) { return 0.5 * (rig.head(bone) + rig.tail(bone)); }

// Returns the point of the constrained bone at which the dashed line begins.
glm::dvec3 begin_of(const ConstraintOnRig& found, const PosedRig& rig) {
  switch (found.constraint.kind) {
    case ConstraintKind::Aim: return rig.head(found.bone);
    case ConstraintKind::Plant: return planted_point(found, rig);
    case ConstraintKind::InverseKinematics: return rig.tail(found.bone);
    default: return middle_of(rig, found.bone);
  }
}

void draw_line(const GizmoPainter& painter, const ConstraintOnRig& found, const PosedRig& rig, Colour colour) {
  const ConstraintTarget needed = constraint_rule(found.constraint.kind).target;
  const glm::dvec3 begin = begin_of(found, rig);
  if (needed == ConstraintTarget::Bone) return painter.line(begin, middle_of(rig, found.target), colour, kWidth, true);
  const glm::dvec3 place = target_place(found, rig);
  painter.line(begin, place, colour, kWidth, true);
  painter.diamond(place, colour, kMark);
  if (found.target >= 0) painter.line(place, middle_of(rig, found.target), colour, kWidth, true);
}

}  // namespace

void draw_constraint_lines(Context& context) {
  if (context.workspace() != Workspace::Pose || !context.document().armature) return;
  const ClipOnRig* clip = clip_on_rig(context);
  const std::optional<ViewProjection> view = clip && clip->constraints() ? body_seen(context) : std::nullopt;
  if (!view) return;
  const PosedRig rig(*clip->armature(), shown_pose(context));
  const GizmoPainter painter(context, *view);
  for (const std::size_t index : clip->constraints()->order()) {
    const Constraint& constraint = clip->constraints()->constraints()->list[index];
    if (!constraint.on || constraint_rule(constraint.kind).target == ConstraintTarget::None) continue;
    const ConstraintOnRig& found = *clip->constraints()->found(index);
    draw_line(painter, found, rig, context.selection->bones.contains(found.bone) ? kViewAccent : kQuiet);
  }
}

}  // namespace limber::editor
