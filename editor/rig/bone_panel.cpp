// SPDX-License-Identifier: AGPL-3.0-or-later
// Panel of the active bone in the Rig workspace: name, parent, head, tail, length, roll, and the limits of the joint at
// its head. Lengths are in mm, shown angles in degrees.
#include <algorithm>
#include <cmath>

#include "core/project/document.h"
#include "core/rig/anatomical_position.h"
#include "editor/context/context.h"
#include "editor/context/field_edit.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/panels.h"
#include "editor/context/selection.h"
#include "editor/context/workspace.h"
#include "editor/rig/rig_edits.h"
#include "editor/ui/input_fields.h"
#include "editor/ui/list_navigation.h"
#include "editor/ui/messages.h"
#include "editor/ui/widgets.h"

namespace limber::editor {

namespace {

constexpr double kFar = 1e5;       // a coordinate or length beyond this cannot be typed, mm
constexpr double kShortest = 0.1;  // a change that makes a bone shorter is rejected, mm

bool too_short(const Bone& bone) { return glm::distance(bone.head, bone.tail) < kShortest; }

// Draws a field for one number of the bone, such as its length. The views show the changed rig while the user edits the
// number, and one edit is committed at the end. Rejects a change that makes the bone shorter than kShortest.
template <class Change>
void draw_number(Context& context, const Rect& rect, const std::string& name, const std::string& label, double shown,
                 double low, double high, const char* format, const char* unit, int bone, const Change& change) {
  auto& edited = context.field_edit->number;
  double value = edited.name == name ? edited.value : shown;
  bool committed = false;
  const std::shared_ptr<const Armature> rig = context.document().armature;
  const auto with = [&](double number) { return mirrored_too(context, change(*rig, number)); };
  if (number_field(context.ui, name, rect, value, low, high, format, unit, false, committed)) {
    edited = {name, value};
    if (Armature next = with(value); !too_short(next.bones[bone])) show_rig(context, std::move(next));
  }
  if (!committed || edited.name != name) return;
  const double number = edited.value;
  edited = {};
  Armature next = with(number);
  if (!too_short(next.bones[bone])) return commit_rig(context, label, std::move(next), {bone});
  drop_shown_rig(context);
  context.messages->warn(rig->bones[bone].name + " stays as it was", "A bone must be at least 0.1 mm long");
}

void draw_name(Context& context, const Rect& rect, int index) {
  const Look& look = context.ui->look;
  const std::string& name = context.document().armature->bones[index].name;
  const std::string renamed = "bone panel " + name;
  if (is_renaming(context.ui, renamed)) {
    std::string accepted = name;
    if (rename_field(context.ui, rect, accepted))
      attempt(context, "Rename bone", [&](Context& c) { rename_bone(c, index, accepted); });
    return;
  }
  const Pressed pressed = press_area(context.ui, "Name", rect);
  fill(rect, pressed.hovered ? look.theme.hover : look.theme.field, look.px(4));
  outline(rect, look.theme.line2, look.px(4), look.line());
  put_text(context.ui, look.fonts.regular, look.theme.text,
           Rect{{rect.low.x + look.px(8), rect.low.y}, {rect.high.x - look.px(8), rect.high.y}}, name);
  if (pressed.clicked) begin_renaming(context.ui, renamed, name);
}

// Draws the field that selects the bone's parent: none, or any bone that is not a descendant of this bone.
void draw_parent(Context& context, const Rect& rect, int index) {
  const std::shared_ptr<const Armature> rig = context.document().armature;
  std::vector<int> parents = {-1};
  std::vector<bool> below(rig->bones.size(), false);
  below[index] = true;
  for (int b = 0; b < std::ssize(rig->bones); ++b) {
    below[b] = below[b] || (rig->bones[b].parent >= 0 && below[rig->bones[b].parent]);
    if (!below[b]) parents.push_back(b);
  }
  std::vector<std::string> names;
  for (const int parent : parents) names.push_back(parent < 0 ? "None" : rig->bones[parent].name);
  int chosen = static_cast<int>(std::find(parents.begin(), parents.end(), rig->bones[index].parent) - parents.begin());
  const PathScope scope(context.ui, "Parent");
  if (choice_field(context.ui, rect, names, chosen))
    attempt(context, "Make parent", [&](Context& c) { hang_on(c, {index}, parents[chosen]); });
}

// Draws the checkbox that connects the bone to its parent. A bone is connected while its head lies on the parent's
// tail. Disconnecting moves the head a little along the bone, so that the head and the parent's tail can then be moved
// independently.
void draw_connected(Context& context, const Rect& rect, int index) {
  // The head moves by the fraction kBack of the bone's length, but by kMostBack mm at most.
  constexpr double kBack = 0.05, kMostBack = 5;
  const std::shared_ptr<const Armature> rig = context.document().armature;
  const Bone& bone = rig->bones[index];
  if (bone.parent < 0) return;
  bool connected = is_connected(*rig, index);
  if (!checkbox(context.ui, "Connected", rect, "Connected", connected)) return;
  attempt(context, connected ? "Connect" : "Disconnect", [&](Context& c) {
    if (connected) {
      Armature next = hung(c, {index}, bone.parent, Join::Connected);
      const int still = next.find(bone.name).value();
      return commit_rig(c, "Connect " + bone.name, std::move(next), {still});
    }
    Armature next = *rig;
    const glm::dvec3 along = bone.tail - bone.head;
    const double length = glm::length(along);
    if (length > 0) next.bones[index].head += along * (std::min(kBack * length, kMostBack) / length);
    commit_rig(c, "Disconnect " + bone.name, mirrored_too(c, std::move(next)), {index});
  });
}

void draw_end(Context& context, Column& column, const Bone& bone, const BoneEnd& end) {
  const Look& look = context.ui->look;
  const std::string which = end.tail ? "Tail" : "Head";
  // This field is wider than the fields of other properties, because it shows three coordinates.
  Rect rect = column.property(which + ", mm");
  rect.low.x = std::round(rect.high.x - std::max(rect.width(), look.px(180)));
  const glm::dvec3 place = end.tail ? bone.tail : bone.head;
  const float width = (rect.width() - 2 * look.px(4)) / 3;
  for (int axis = 0; axis < 3; ++axis) {
    const float x = std::round(rect.low.x + static_cast<float>(axis) * (width + look.px(4)));
    const Rect field{{x, rect.low.y}, {std::round(x + width), rect.high.y}};
    draw_number(context, {{field.low.x + look.px(3), field.low.y}, field.high}, which + " " + "XYZ"[axis],
                "Move " + bone.name, place[axis], -kFar, kFar, "%.1f", "", end.bone,
                [&](const Armature& rig, double number) {
                  return with_moved_ends(rig, {end}, [&](glm::dvec3 p) {
                    p[axis] = number;
                    return p;
                  });
                });
    fill({field.low, {field.low.x + look.px(3), field.high.y}}, look.theme.axis[axis]);
  }
}

// Choices for the axis of a hinge: the bone's local axes and their opposites. Positive angles turn the hinge about this
// axis by the right-hand rule.
const std::vector<std::string> kAxes = {"Local X",       "Local Y",       "Local Z",
                                        "Local \u2212X", "Local \u2212Y", "Local \u2212Z"};
constexpr int kOtherAxis = 6;

glm::dvec3 own_axis(const Bone& bone, int choice) { return rest_axes(bone)[choice % 3] * (choice < 3 ? 1.0 : -1.0); }

int axis_choice(const Bone& bone) {
  for (int choice = 0; choice < kOtherAxis; ++choice)
    if (glm::dot(own_axis(bone, choice), bone.limits.axis) > 0.9999) return choice;
  return kOtherAxis;
}

Armature with_limits(const Armature& rig, int bone, const JointLimits& limits) {
  Armature next = rig;
  next.bones[bone].limits = limits;
  return next;
}

// Draws the fields for the lower and the upper limit of a joint angle, in degrees. The stored limits are relative to
// the rest pose; the shown limits have `at_rest`, the angle in the rest pose, added. The fields do not accept limits
// that exclude the rest pose.
void draw_range(Context& context, Column& column, const Bone& bone, int index, const std::string& label,
                double JointLimits::*low, double JointLimits::*high, double at_rest) {
  const double zero = glm::degrees(at_rest);
  const Rect rect = column.property(label);
  const float middle = std::round(rect.centre().x), gap = context.ui->look.px(2);
  const auto number = [&](const Rect& field, const std::string& name, double JointLimits::*angle, double from,
                          double to) {
    draw_number(context, field, name, "Set limits of " + bone.name, glm::degrees(bone.limits.*angle) + zero,
                from + zero, to + zero, "%.0f", "\u00b0", index, [&](const Armature& rig, double degrees) {
                  JointLimits limits = rig.bones[index].limits;
                  limits.*angle = glm::radians(degrees - zero);
                  return with_limits(rig, index, limits);
                });
  };
  number({rect.low, {middle - gap, rect.high.y}}, label + " from", low, -180,
         std::min(0.0, glm::degrees(bone.limits.*high)));
  number({{middle + gap, rect.low.y}, rect.high}, label + " to", high, std::max(0.0, glm::degrees(bone.limits.*low)),
         180);
}

void draw_joint(Context& context, Column& column, const Bone& bone, int index) {
  const std::vector<std::string> kinds = {"Free", "Fixed", "Hinge", "Ball"};
  int kind = static_cast<int>(bone.limits.type);
  if (column.begin_section("Joint", kinds[kind], false)) {
    column.space(6);
    const std::shared_ptr<const Armature> rig = context.document().armature;
    const auto choose = [&](const std::string& label, const std::vector<std::string>& choices, int& chosen) {
      const Rect rect = column.property(label);
      const PathScope scope(context.ui, label);
      return choice_field(context.ui, rect, choices, chosen);
    };
    if (choose("Kind", kinds, kind)) {
      JointLimits limits;
      limits.type = static_cast<JointLimits::Type>(kind);
      if (limits.type == JointLimits::Type::Hinge)
        limits.axis = rest_axes(bone)[0], limits.maximum = glm::radians(90.0);
      if (limits.type == JointLimits::Type::Ball)
        limits.cone = limits.twist_maximum = glm::radians(45.0), limits.twist_minimum = -limits.twist_maximum;
      commit_rig(context, "Set limits of " + bone.name, mirrored_too(context, with_limits(*rig, index, limits)),
                 {index});
    }
    if (bone.limits.type == JointLimits::Type::Hinge) {
      int axis = axis_choice(bone);
      std::vector<std::string> axes = kAxes;
      if (axis == kOtherAxis) axes.push_back("Other");  // the axis is none of the bone's local axes
      if (choose("Axis", axes, axis)) {
        JointLimits limits = bone.limits;
        limits.axis = own_axis(bone, axis);
        commit_rig(context, "Set hinge of " + bone.name, mirrored_too(context, with_limits(*rig, index, limits)),
                   {index});
      }
      draw_range(context, column, bone, index, "Angle", &JointLimits::minimum, &JointLimits::maximum,
                 hinge_angle_at_rest(*rig, index, bone.limits.axis));
    }
    if (bone.limits.type == JointLimits::Type::Ball) {
      draw_number(context, column.property("Cone"), "Cone", "Set limits of " + bone.name,
                  glm::degrees(bone.limits.cone), 0, 180, "%.0f", "\u00b0", index,
                  [&](const Armature& before, double degrees) {
                    JointLimits limits = before.bones[index].limits;
                    limits.cone = glm::radians(degrees);
                    return with_limits(before, index, limits);
                  });
      draw_range(context, column, bone, index, "Twist", &JointLimits::twist_minimum, &JointLimits::twist_maximum, 0);
    }
    operator_button(context, "rig.motion_range", column.property("Usual range"), "Set limits...");
    column.space(6);
  }
  column.end_section();
}

}  // namespace

void draw_bone(Context& context, Column& column) {
  const std::shared_ptr<const Armature> rig = shown_rig(context);
  const auto chosen = context.selection->bone;
  if (context.workspace() != Workspace::Rig || !rig || !chosen || *chosen >= std::ssize(rig->bones) ||
      *chosen >= std::ssize(context.document().armature->bones))
    return;
  const int index = *chosen;
  const Bone bone = rig->bones[index];
  const Look& look = context.ui->look;
  if (column.begin_section("Bone", bone.name)) {
    column.space(6);
    draw_name(context, column.property("Name"), index);
    draw_parent(context, column.property("Parent"), index);
    draw_connected(context, column.property(""), index);
    draw_end(context, column, bone, {index, false});
    draw_end(context, column, bone, {index, true});
    Rect rect = column.property("Length \u00b7 roll");
    rect.low.x = std::round(rect.high.x - std::max(rect.width(), look.px(156)));
    const float middle = std::round(rect.low.x + 0.56f * rect.width());
    draw_number(context, {rect.low, {middle - look.px(2), rect.high.y}}, "Length", "Set length of " + bone.name,
                glm::distance(bone.head, bone.tail), 0, kFar, "%.1f", "mm", index,
                [&](const Armature& before, double number) {
                  const glm::dvec3 along = before.bones[index].tail - before.bones[index].head;
                  const double length = glm::length(along);
                  return with_moved_ends(before, {{index, true}}, [&](const glm::dvec3&) {
                    return before.bones[index].head + (length > 0 ? along / length : glm::dvec3(0, 0, 1)) * number;
                  });
                });
    draw_number(context, {{middle + look.px(2), rect.low.y}, rect.high}, "Roll", "Roll " + bone.name,
                glm::degrees(bone.roll), -180, 180, "%.1f", "\u00b0", index,
                [&](const Armature& before, double number) {
                  return rolled(before, {index}, glm::radians(number) - before.bones[index].roll);
                });
    column.space(6);
  }
  column.end_section();
  draw_joint(context, column, bone, index);
}

}  // namespace limber::editor
