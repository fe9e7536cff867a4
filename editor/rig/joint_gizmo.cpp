// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/rig/joint_gizmo.h"

#include "editor/rig/rig_edits.h"
#include "editor/rig/rig_transform_tool.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

// Pixels at scale 1: length of the drawn hinge axis, distance of the roll handle from the bone, and distance from a
// handle within which a click hits it.
constexpr double kAxis = 124, kKnob = 30, kHit = 9;

// Returns the active bone if its joint handles are shown in this view, else null.
const Bone* handled_bone(const Editor& editor, const Armature* rig, const ViewProjection& view) {
  const auto bone = editor.selection.bone;
  const bool wanted = editor.workspace == Workspace::Rig && editor.tool == Tool::Rotate &&
                      view.place.id == ViewId::Body && editor.views->bones;
  return wanted && rig && bone && *bone < std::ssize(rig->bones) ? &rig->bones[*bone] : nullptr;
}

bool is_at(const ViewProjection& view, const std::optional<glm::dvec3>& handle, const glm::dvec2& pixel, float scale) {
  const auto seen = handle ? view.pixel_of(*handle) : std::nullopt;
  return seen && glm::distance(*seen, pixel) <= kHit * scale;
}

}  // namespace

std::optional<glm::dvec3> hinge_handle(const Editor& editor, const ViewProjection& view) {
  const std::shared_ptr<const Armature> rig = shown_rig(editor);
  const Bone* bone = handled_bone(editor, rig.get(), view);
  if (!bone || bone->limits.type != JointLimits::Type::Hinge) return std::nullopt;
  return bone->head + bone->limits.axis * (kAxis * editor.look.scale * view.millimetres_per_pixel(bone->head));
}

std::optional<glm::dvec3> roll_handle(const Editor& editor, const ViewProjection& view) {
  const std::shared_ptr<const Armature> rig = shown_rig(editor);
  const Bone* bone = handled_bone(editor, rig.get(), view);
  if (!bone || bone->head == bone->tail) return std::nullopt;
  const glm::dvec3 middle = (bone->head + bone->tail) / 2.0;
  return middle + rest_axes(*bone)[0] * (kKnob * editor.look.scale * view.millimetres_per_pixel(middle));
}

bool press_joint_handle(Editor& editor, const ViewProjection& view) {
  const glm::dvec2 pixel(editor.input.pointer);
  const bool hinge = is_at(view, hinge_handle(editor, view), pixel, editor.look.scale);
  if (!hinge && !is_at(view, roll_handle(editor, view), pixel, editor.look.scale)) return false;
  const Grip grip{.lock = {hinge ? -1 : 1, Space::Local}, .held = MouseButton::Left};
  begin_tool(editor, hinge ? begin_hinge_change(editor, grip)
                           : begin_rig_change(editor, chosen_change(editor, RigChange::Kind::Roll), grip));
  return true;
}

void draw_joint_handles(Editor& editor, const ViewProjection& view) {
  const GizmoPainter painter(editor, view);
  const Theme& theme = editor.look.theme;
  const std::shared_ptr<const Armature> rig = shown_rig(editor);
  const Bone* bone = handled_bone(editor, rig.get(), view);
  if (!bone) return;
  const glm::dvec2 pixel(editor.input.pointer);
  const auto put = [&](const std::optional<glm::dvec3>& handle, const glm::dvec3& from, Colour colour) {
    if (!handle) return;
    const bool hovered = !editor.modal && is_at(view, handle, pixel, editor.look.scale);
    painter.line(from, *handle, with_alpha(colour, hovered ? 1 : 0.8f), 2);
    painter.dot(*handle, hovered ? kGizmoActive : colour, 0xFF1A1614, 6);
  };
  put(hinge_handle(editor, view), bone->head, kViewWarn);
  put(roll_handle(editor, view), (bone->head + bone->tail) / 2.0, theme.axis[0]);
}

}  // namespace limber::editor
