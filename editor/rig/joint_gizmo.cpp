// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/rig/joint_gizmo.h"

#include "editor/context/context.h"
#include "editor/context/interaction.h"
#include "editor/context/selection.h"
#include "editor/context/views.h"
#include "editor/context/workspace.h"
#include "editor/rig/rig_edits.h"
#include "editor/rig/rig_transform_tool.h"
#include "editor/ui/ui.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

// Pixels at scale 1: length of the drawn hinge axis, distance of the roll handle from the bone, and distance from a
// handle within which a click hits it.
constexpr double kAxis = 124, kKnob = 30, kHit = 9;

// Returns the active bone if its joint handles are shown in this view, else null.
const Bone* handled_bone(const Context& context, const Armature* rig, const ViewProjection& view) {
  const auto bone = context.selection->bone;
  const bool wanted = context.workspace() == Workspace::Rig && context.interaction->tool == Tool::Rotate &&
                      view.place.id == ViewId::Body && context.views->bones;
  return wanted && rig && bone && *bone < std::ssize(rig->bones) ? &rig->bones[*bone] : nullptr;
}

bool is_at(const ViewProjection& view, const std::optional<glm::dvec3>& handle, const glm::dvec2& pixel, float scale) {
  const auto seen = handle ? view.pixel_of(*handle) : std::nullopt;
  return seen && glm::distance(*seen, pixel) <= kHit * scale;
}

}  // namespace

std::optional<glm::dvec3> hinge_handle(const Context& context, const ViewProjection& view) {
  const std::shared_ptr<const Armature> rig = shown_rig(context);
  const Bone* bone = handled_bone(context, rig.get(), view);
  if (!bone || bone->limits.type != JointLimits::Type::Hinge) return std::nullopt;
  return bone->head + bone->limits.axis * (kAxis * context.ui->look.scale * view.millimetres_per_pixel(bone->head));
}

std::optional<glm::dvec3> roll_handle(const Context& context, const ViewProjection& view) {
  const std::shared_ptr<const Armature> rig = shown_rig(context);
  const Bone* bone = handled_bone(context, rig.get(), view);
  if (!bone || bone->head == bone->tail) return std::nullopt;
  const glm::dvec3 middle = (bone->head + bone->tail) / 2.0;
  return middle + rest_axes(*bone)[0] * (kKnob * context.ui->look.scale * view.millimetres_per_pixel(middle));
}

bool press_joint_handle(Context& context, const ViewProjection& view) {
  const glm::dvec2 pixel(context.ui->input.pointer);
  const bool hinge = is_at(view, hinge_handle(context, view), pixel, context.ui->look.scale);
  if (!hinge && !is_at(view, roll_handle(context, view), pixel, context.ui->look.scale)) return false;
  const Grip grip{.lock = {hinge ? -1 : 1, Space::Local}, .held = MouseButton::Left};
  begin_tool(context, hinge ? begin_hinge_change(context, grip)
                            : begin_rig_change(context, chosen_change(context, RigChange::Kind::Roll), grip));
  return true;
}

void draw_joint_handles(Context& context, const ViewProjection& view) {
  const GizmoPainter painter(context, view);
  const Theme& theme = context.ui->look.theme;
  const std::shared_ptr<const Armature> rig = shown_rig(context);
  const Bone* bone = handled_bone(context, rig.get(), view);
  if (!bone) return;
  const glm::dvec2 pixel(context.ui->input.pointer);
  const auto put = [&](const std::optional<glm::dvec3>& handle, const glm::dvec3& from, Colour colour) {
    if (!handle) return;
    const bool hovered = !context.interaction->modal && is_at(view, handle, pixel, context.ui->look.scale);
    painter.line(from, *handle, with_alpha(colour, hovered ? 1 : 0.8f), 2);
    painter.dot(*handle, hovered ? kGizmoActive : colour, 0xFF1A1614, 6);
  };
  put(hinge_handle(context, view), bone->head, kViewWarn);
  put(roll_handle(context, view), (bone->head + bone->tail) / 2.0, theme.axis[0]);
}

}  // namespace limber::editor
