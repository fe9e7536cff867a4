// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/pose/pose_bone_panel.h"

#include <cmath>
#include <cstdio>
#include <functional>

#include "core/rig/anatomical_position.h"
#include "core/rig/joint_angle.h"
#include "editor/context/context.h"
#include "editor/context/field_edit.h"
#include "editor/context/operator_button.h"
#include "editor/context/selection.h"
#include "editor/input/keymap_overrides.h"
#include "editor/motion/timeline.h"
#include "editor/pose/pose_edits.h"
#include "editor/ui/axis_fields.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

namespace {

constexpr double kFar = 1e5;  // the offset of the body from rest is limited to plus or minus this along each axis, mm

// Draws a field for one number of the pose, such as an angle, with the range from -farthest to +farthest. The views
// show the changed pose while the user edits the number, and one edit is committed at the end.
//   set  called with a pose and the new number; changes the pose
void draw_number(Context& context, const Rect& rect, const std::string& name, const std::string& label, double shown,
                 double farthest, const char* format, const char* unit, const std::function<void(Pose&, double)>& set) {
  auto& edited = context.field_edit->number;
  double value = edited.name == name ? edited.value : shown;
  bool committed = false;
  const auto changed = [&](double number) {
    const Pose before = pose_of(context.document());
    Pose pose = before;
    set(pose, number);
    return limited(context, mirrored_too(context, before, std::move(pose)), {*context.selection->bone});
  };
  if (number_field(context.ui, name, rect, value, -farthest, farthest, format, unit, false, committed)) {
    stop_playing(context);
    settle_frame(context);
    edited = {name, value};
    const Pose pose = changed(value);
    preview_pose(context, pose, changed_bones(pose_of(context.document()), pose));
  }
  if (!committed || edited.name != name) return;
  const double number = edited.value;
  edited = {};
  const Pose pose = changed(number);
  commit_pose(context, label, pose, changed_bones(pose_of(context.document()), pose));
}

// Draws number fields for x, y and z in one row.
void draw_three(Context& context, Column& column, const std::string& title, const std::string& label,
                const glm::dvec3& shown, double farthest, const std::function<void(Pose&, int axis, double)>& set) {
  const std::array<Rect, 3> fields = lay_axis_fields(context.ui->look, column, title);
  for (int axis = 0; axis < 3; ++axis)
    draw_number(context, fields[static_cast<std::size_t>(axis)], title + " " + "XYZ"[axis], label, shown[axis],
                farthest, "%.1f", "", [&](Pose& pose, double number) { set(pose, axis, number); });
}

// Returns the rotation with one component of its quaternion set to `value`, and the other three scaled so that the
// quaternion has unit length. Returns the rotation unchanged when the other three are zero.
glm::dquat with_part(const glm::dquat& rotation, int part, double value) {
  glm::dvec4 q(rotation.w, rotation.x, rotation.y, rotation.z);
  q[part] = 0;
  const double others = glm::length(q);
  if (others < 1e-9) return rotation;
  q *= std::sqrt(std::max(0.0, 1 - value * value)) / others;
  q[part] = value;
  return glm::normalize(glm::dquat(q[0], q[1], q[2], q[3]));
}

// Draws four fields for the components w, x, y and z of the bone's quaternion.
void draw_quaternion(Context& context, Column& column, const std::string& label, int bone, const glm::dquat& rotation) {
  const Look& look = context.ui->look;
  Rect rect = column.property("W X Y Z");
  rect.low.x = std::round(rect.high.x - std::max(rect.width(), look.px(180)));
  const glm::dquat shown = rotation.w < 0 ? -rotation : rotation;
  const double parts[] = {shown.w, shown.x, shown.y, shown.z};
  const float width = (rect.width() - 3 * look.px(2)) / 4;
  for (int part = 0; part < 4; ++part) {
    const float x = std::round(rect.low.x + static_cast<float>(part) * (width + look.px(2)));
    draw_number(context, {{x, rect.low.y}, {std::round(x + width), rect.high.y}},
                std::string("Quaternion ") + "WXYZ"[part], label, parts[part], 1, "%.2f", "",
                [&](Pose& next, double value) {
                  next.rotation[bone] =
                      with_part(next.rotation[bone].w < 0 ? -next.rotation[bone] : next.rotation[bone], part, value);
                });
  }
}

void draw_ik(Context& context, Column& column) {
  const Rect rect = column.property("IK");
  const float middle = std::round(rect.low.x + 0.58f * rect.width());
  operator_box(context, "pose.pin", {rect.low, {middle - context.ui->look.px(4), rect.high.y}}, "Pin joint");
  operator_box(context, "pose.pole", {{middle, rect.low.y}, rect.high}, "Pole");
}

std::string text_of(const char* format, double radians) {
  char text[48];
  std::snprintf(text, sizeof text, format, glm::degrees(radians));
  return text;
}

// Returns the joint's limits as text, such as "0 to 150" degrees. A hinge's angles are 0 in the anatomical position.
//   at_rest  the hinge's angle in the rest pose, radians
std::string words_of(const JointLimits& limits, double at_rest) {
  switch (limits.type) {
    case JointLimits::Type::Free: return "none";
    case JointLimits::Type::Fixed: return "fixed";
    case JointLimits::Type::Hinge:
      return std::to_string(std::lround(glm::degrees(limits.minimum + at_rest))) +
             text_of(" to %.0f\u00b0", limits.maximum + at_rest);
    case JointLimits::Type::Ball:
      return text_of("cone %.0f\u00b0, twist ", limits.cone) + text_of("%.0f", limits.twist_minimum) +
             text_of(" to %.0f\u00b0", limits.twist_maximum);
  }
  return "";
}

}  // namespace

void draw_posed_bone(Context& context, Column& column) {
  const std::shared_ptr<const Armature> rig = context.document().armature;
  const auto chosen = context.selection->bone;
  if (!rig || !chosen || *chosen >= std::ssize(rig->bones)) return;
  const int index = *chosen;
  const Bone& bone = rig->bones[index];
  const Look& look = context.ui->look;
  if (column.begin_section("Bone", bone.name)) {
    column.space(6);
    const Pose pose = shown_pose(context);
    const std::string label = "Rotate " + bone.name;
    const glm::dvec3 at_rest = turn_at_rest(*rig, index);
    const double zero = glm::dot(at_rest, bone.limits.axis);  // hinge angle in the rest pose, radians
    if (bone.limits.type == JointLimits::Type::Hinge) {
      const glm::dvec3 axis = bone.limits.axis;
      draw_number(context, column.property("Angle"), "Angle", label,
                  glm::degrees(swing_twist(pose.rotation[index], axis).twist + zero), 360, "%.1f", "\u00b0",
                  [&](Pose& next, double degrees) {
                    next.rotation[index] = glm::angleAxis(glm::radians(degrees) - zero, axis);
                  });
    } else {
      draw_three(context, column, "Rotation, \u00b0", label, own_angles(bone, pose.rotation[index]), 180,
                 [&](Pose& next, int axis, double degrees) {
                   // The other two angles are computed from the unchanged pose `next`, so that they stay the same
                   // during a drag. Angles that are computed from the changed rotation would jump when the angle about
                   // y passes 90 degrees.
                   glm::dvec3 angles = own_angles(bone, next.rotation[index]);
                   angles[axis] = degrees;
                   next.rotation[index] = turned_by_own_angles(bone, angles);
                 });
    }
    draw_quaternion(context, column, label, index, pose.rotation[index]);
    if (bone.parent < 0)
      draw_three(context, column, "Shift, mm", "Move body", pose.root_translation, kFar,
                 [](Pose& next, int axis, double place) { next.root_translation[axis] = place; });
    draw_ik(context, column);
    const std::string beyond = excess_text(bone, pose.rotation[index], at_rest);
    Rect limits = column.property("Limits");
    limits.low.x = std::round(limits.high.x - std::max(limits.width(), look.px(200)));
    put_text(context.ui, look.fonts.regular, beyond.empty() ? look.theme.text2 : look.theme.warn, limits,
             beyond.empty() ? words_of(bone.limits, zero) : beyond, Align::Right);
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
