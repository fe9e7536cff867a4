// SPDX-License-Identifier: AGPL-3.0-or-later
// Modal tool in which the axis of the active bone's hinge joint follows the pointer.
#include <algorithm>
#include <cmath>

#include "core/project/document.h"
#include "editor/context/context.h"
#include "editor/context/layout.h"
#include "editor/context/selection.h"
#include "editor/input/keymap_overrides.h"
#include "editor/rig/rig_edits.h"
#include "editor/rig/rig_transform_tool.h"
#include "editor/ui/ui.h"
#include "editor/viewport/gizmo_draw.h"

namespace limber::editor {

namespace {

constexpr double kReach = 124;  // distance from the joint to the dragged end of the axis, pixels at scale 1

class HingeTool final : public TransformTool {
 public:
  HingeTool(Context& context, const Grip& grip)
      : TransformTool(context, grip),
        rig_(*context.document().armature),
        bone_(*context.selection->bone),
        before_(rig_.bones[bone_].limits.axis),
        axis_(before_) {
    const glm::dvec3& head = rig_.bones[bone_].head;
    from_ = head + before_ * (kReach * context.ui->look.scale * view_.millimetres_per_pixel(head));
    show(context);
  }

  std::string title() const override {
    return "Hinge of " + rig_.bones[bone_].name + ", turned by " + text_of_number("%.1f", degrees()) + "\u00b0";
  }
  std::vector<KeyHint> hints(const Context&) const override {
    return {{{"X", "Y", "Z"}, "World axis (twice: local)"},
            {{"0-9"}, "Turn by degrees"},
            {{"Ctrl"}, "Snap to local axes"},
            {{"Shift"}, "Precise"},
            {{"Enter"}, "Confirm"},
            {{"Esc"}, "Cancel"}};
  }
  void cancel(Context& context) override { drop_shown_rig(context); }

  void draw(Context& context, const ViewPlace& place) override {
    if (place.id != view_.place.id) return;
    const glm::dvec3& head = rig_.bones[bone_].head;
    const double reach = glm::distance(head, from_);
    const GizmoPainter painter(context, view_);
    painter.line(head - axis_ * reach, head + axis_ * reach, kGizmoActive, 2);
    painter.dot(head + axis_ * reach, kGizmoActive, 0xFF1A1614, 6);
    painter.read_out(head + axis_ * reach,
                     (number_.typed() ? number_.text() : text_of_number("%.1f", degrees())) + "\u00b0",
                     lock_.axis < 0 ? "" : lock_text(number_.typed() ? "about" : "along").substr(1),
                     rig_.bones[bone_].name, context.ui->look.theme.view_text2);
  }

 private:
  glm::dmat3 axes(Space space) const override { return axes_of(space, rig_, rest_pose(rig_), bone_, view_); }
  double degrees() const { return glm::degrees(std::acos(std::clamp(glm::dot(axis_, before_), -1.0, 1.0))); }

  // Returns the hinge's new axis, a unit vector. A typed number turns the old axis by that many degrees about the
  // locked axis, or about the line of sight when no axis is locked. Without a number, the new axis is the locked axis
  // or its opposite, whichever is nearer to the old axis. Without a number and a locked axis, the new axis points at
  // the pointer; Ctrl snaps the axis to the nearest of the bone's local axes.
  glm::dvec3 pointed_at(Context& context) {
    if (number_.typed())
      return glm::angleAxis(glm::radians(number_.value()), lock_.axis >= 0 ? lock_axis() : view_.towards_eye) * before_;
    if (lock_.axis >= 0) return lock_axis() * (glm::dot(lock_axis(), before_) < 0 ? -1.0 : 1.0);
    const glm::dvec3 towards = dragged(context, from_, 0, 0) - rig_.bones[bone_].head;
    if (glm::length(towards) < 1e-9) return axis_;
    const glm::dvec3 axis = glm::normalize(towards);
    if (context.ui->input.down(Key::Ctrl) == context.transform_settings->snapping) return axis;
    const glm::dmat3 own = rest_axes(rig_.bones[bone_]);
    glm::dvec3 nearest = own[0];
    for (int i = 0; i < 6; ++i)
      if (const glm::dvec3 one = own[i % 3] * (i < 3 ? 1.0 : -1.0); glm::dot(one, axis) > glm::dot(nearest, axis))
        nearest = one;
    return nearest;
  }

  Armature changed(Context& context) {
    axis_ = pointed_at(context);
    Armature next = rig_;
    next.bones[bone_].limits.axis = axis_;
    return mirrored_too(context, std::move(next));
  }

  void show(Context& context) override { show_rig(context, changed(context)); }
  void keep(Context& context) override {
    commit_rig(context, "Set hinge of " + rig_.bones[bone_].name, changed(context), {bone_});
  }

  const Armature rig_;
  int bone_;
  glm::dvec3 before_, axis_, from_{0};
};

}  // namespace

std::unique_ptr<TransformTool> begin_hinge_change(Context& context, const Grip& grip) {
  return std::make_unique<HingeTool>(context, grip);
}

}  // namespace limber::editor
