// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/pose/clinical_angles_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "core/pose/joint_turns.h"
#include "editor/context/context.h"
#include "editor/context/field_edit.h"
#include "editor/context/selection.h"
#include "editor/motion/timeline.h"
#include "editor/pose/clinical_angle_edits.h"
#include "editor/pose/pose_edits.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

namespace {

constexpr double kFarthest = 360;  // an angle beyond plus or minus this cannot be typed, degrees
// The slider extends beyond each end of the range of motion by this fraction of the range.
constexpr double kBeside = 0.2;
// An angle that exceeds the range by more than this is marked, degrees; numbers show one decimal.
constexpr double kBeyond = 0.05;

std::string capitalized(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string degrees_text(double degrees) { return std::to_string(std::lround(degrees)) + "\u00b0"; }

// An angle of a joint that the panel shows and lets the user change.
struct ShownAngle {
  std::string name;   // full name, different for each angle of the panel: "Left hip flexion"
  std::string label;  // the name without side and joint: "Flexion"
  std::string help;
  double degrees = 0;
  AngleRange range;
  std::function<Pose(double degrees)> pose_at;  // returns the pose with this angle changed
};

// Shows the pose with the changed angle while the user drags or types, and commits one edit at the end.
void take_change(Context& context, const ShownAngle& angle, bool changed, bool committed, double value) {
  auto& edited = context.field_edit->number;
  if (changed) {
    stop_playing(context);
    settle_frame(context);
    edited = {angle.name, value};
    const Pose pose = angle.pose_at(value);
    preview_pose(context, pose, changed_bones(pose_of(context.document()), pose));
  }
  if (!committed || edited.name != angle.name) return;
  const double number = edited.value;
  edited = {};
  const Pose pose = angle.pose_at(number);
  commit_pose(context, "Set " + angle.name, pose, changed_bones(pose_of(context.document()), pose));
}

void draw_number_of(Context& context, const ShownAngle& angle, const Rect& rect, double shown) {
  bool committed = false;
  double value = shown;
  const bool changed =
      number_field(context.ui, angle.name, rect, value, -kFarthest, kFarthest, "%.1f", "\u00b0", false, committed);
  take_change(context, angle, changed, committed, value);
}

// Draws the slider: a track with a bar for the range of the motion, a tick at zero, and a handle at the angle.
void draw_slider(Context& context, const ShownAngle& angle, const Rect& rect, double shown) {
  const Look& look = context.ui->look;
  const double width = angle.range.high - angle.range.low, low = angle.range.low - kBeside * width,
               high = angle.range.high + kBeside * width;
  const auto x_of = [&](double degrees) {
    return rect.low.x + rect.width() * static_cast<float>(std::clamp((degrees - low) / (high - low), 0.0, 1.0));
  };
  const Pressed pressed = press_area(context.ui, "Slide " + angle.name, rect);
  const bool released = ImGui::IsItemDeactivated();
  auto& edited = context.field_edit->number;
  if (pressed.activated) edited = {angle.name, shown};
  // If the panel is folded or another workspace is shown during a drag, the drag ends without a release. In this case,
  // the edited number is forgotten.
  else if (edited.name == angle.name && !pressed.held && !released && !ImGui::IsAnyItemActive()) edited = {};
  if (edited.name == angle.name && pressed.held && context.ui->input.down(Key::Escape)) {
    edited = {};
    drop_shown_pose(context);
  } else if (edited.name == angle.name && (pressed.held || released)) {
    const double share = (context.ui->input.pointer.x - rect.low.x) / std::max(1.0f, rect.width());
    const double value = pressed.held ? std::round(low + std::clamp(share, 0.0, 1.0) * (high - low)) : edited.value;
    take_change(context, angle, pressed.held && (pressed.activated || value != edited.value), released, value);
  }
  const float middle = std::round(rect.centre().y), half = look.px(2);
  fill({{rect.low.x, middle - half}, {rect.high.x, middle + half}}, look.theme.field, half);
  fill({{x_of(angle.range.low), middle - half}, {x_of(angle.range.high), middle + half}}, look.theme.accent_soft, half);
  if (low < 0 && high > 0) {
    const float zero = std::round(x_of(0));
    fill({{zero, middle - look.px(5)}, {zero + look.line(), middle + look.px(5)}}, look.theme.text3);
  }
  const bool beyond = shown < angle.range.low - kBeyond || shown > angle.range.high + kBeyond;
  const float at = std::round(x_of(shown));
  fill({{at - look.px(3), middle - look.px(6)}, {at + look.px(3), middle + look.px(6)}},
       beyond                            ? look.theme.warn
       : pressed.hovered || pressed.held ? look.theme.accent_text
                                         : look.theme.accent,
       look.px(2));
  if (pressed.hovered && !pressed.held) tooltip(context.ui, rect, angle.label, angle.help);
}

// Draws an angle in two lines: its name and number, then its slider between the ends of its range.
void draw_angle(Context& context, Column& column, const ShownAngle& angle) {
  const Look& look = context.ui->look;
  const Rect row = column.row(44);
  const float left = row.low.x + look.px(10), right = row.high.x - look.px(10), line = row.low.y + look.px(24);
  const double shown = context.field_edit->number.name == angle.name ? context.field_edit->number.value : angle.degrees;
  const Rect field{{right - look.px(72), row.low.y + look.px(2)}, {right, line}};
  put_text(context.ui, look.fonts.regular, look.theme.text2, Rect{{left, field.low.y}, {field.low.x, line}},
           angle.label);
  draw_number_of(context, angle, field, shown);
  const float ends = look.px(38), bottom = row.high.y - look.px(4);
  put_text(context.ui, look.fonts.small, look.theme.text3, Rect{{left, line}, {left + ends, bottom}},
           degrees_text(angle.range.low));
  put_text(context.ui, look.fonts.small, look.theme.text3, Rect{{right - ends, line}, {right, bottom}},
           degrees_text(angle.range.high), Align::Right);
  draw_slider(context, angle, {{left + ends, line}, {right - ends, bottom}}, shown);
}

ShownAngle shown_angle(Context& context, const SidedJoint& joint, std::size_t motion, double degrees) {
  const std::string name = std::string(motion_name(joint.joint, motion)),
                    opposite = std::string(opposite_name(joint.joint, motion));
  ShownAngle angle;
  angle.name = capitalized(name_of(joint) + " " + name);
  angle.label = capitalized(name);
  angle.degrees = degrees;
  angle.range = range_of_motion(*context.document().armature, body_frames_of_rig(context), joint, motion);
  angle.help = "The bar is the range of this motion, " + degrees_text(angle.range.low) + " to " +
               degrees_text(angle.range.high) + ", from the anatomical position." +
               (opposite.empty() ? "" : " Negative angles are " + opposite + ".");
  angle.pose_at = [&context, joint, motion](double value) { return pose_at_angle(context, joint, motion, value); };
  return angle;
}

void draw_joint(Context& context, Column& column, const SidedJoint& joint, const JointMotions& motions) {
  const Look& look = context.ui->look;
  const Rect head = column.row(24);
  put_text(context.ui, look.fonts.semibold, look.theme.text, Rect{{head.low.x + look.px(10), head.low.y}, head.high},
           capitalized(name_of(joint)));
  for (std::size_t i = 0; i < motions.size(); ++i)
    if (motions[i]) draw_angle(context, column, shown_angle(context, joint, i, *motions[i]));
  if (!at_gimbal_lock(joint.joint, motions)) return;
  const bool wrist = joint.joint == BodyJoint::Wrist || joint.joint == BodyJoint::Girdle;
  const std::string text = "At 90\u00b0 of " + std::string(motion_name(joint.joint, wrist ? 0 : 1)) +
                           ", the joint's other motions turn about the same axis.";
  const Rect row = column.row(36);
  put_wrapped(context.ui, look.fonts.small, look.theme.text2, {row.low.x + look.px(10), row.low.y},
              row.width() - look.px(20), text);
}

void draw_hand(Context& context, Column& column, BodySide side, const HandShape& shape) {
  const Look& look = context.ui->look;
  const std::string hand = side == BodySide::Left ? "Left hand" : side == BodySide::Right ? "Right hand" : "Hand";
  const Rect head = column.row(24);
  put_text(context.ui, look.fonts.semibold, look.theme.text, Rect{{head.low.x + look.px(10), head.low.y}, head.high},
           hand);
  for (const HandMotion motion : {HandMotion::Curl, HandMotion::Spread}) {
    const bool curl = motion == HandMotion::Curl;
    const std::optional<double> degrees = curl ? shape.curl : shape.spread;
    if (!degrees) continue;
    ShownAngle angle{hand + (curl ? " curl" : " spread"), curl ? "Curl of the fingers" : "Spread of the fingers"};
    angle.help = curl ? "Bend all joints of the fingers together, and the thumb by half."
                      : "Spread the fingers away from the middle finger.";
    angle.degrees = *degrees;
    angle.range = range_of_hand(motion);
    angle.pose_at = [&context, side, motion](double value) { return pose_of_hand(context, side, motion, value); };
    draw_angle(context, column, angle);
  }
}

// Draws the list that selects the bone of a joint.
void draw_choice(Context& context, Column& column, const std::vector<SidedJoint>& joints,
                 const std::vector<SidedJoint>& shown) {
  std::vector<std::string> names{"Select a joint"};
  int chosen = 0;
  for (const SidedJoint& joint : joints) {
    if (!shown.empty() && joint == shown.front()) chosen = static_cast<int>(names.size());
    names.push_back(capitalized(name_of(joint)));
  }
  const PathScope path(context.ui, "Joint");
  Rect rect = column.property("Joint");
  rect.low.x = std::round(rect.high.x - std::max(rect.width(), context.ui->look.px(190)));
  if (!choice_field(context.ui, rect, names, chosen) || chosen == 0) return;
  const std::vector<int> bones =
      bones_turned_by(body_frames_of_rig(context), joints[static_cast<std::size_t>(chosen - 1)]);
  if (bones.empty()) return;
  *context.selection = {};
  context.selection->bone = bones.front();
  context.selection->bones = {bones.front()};
}

}  // namespace

void draw_clinical_angles(Context& context, Column& column) {
  const std::shared_ptr<const Armature> rig = context.document().armature;
  if (!rig) return;
  const BodyFrames frames = body_frames_of_rig(context);
  const std::vector<SidedJoint> joints = joints_known_by_name(frames);
  if (joints.empty()) return;
  const auto chosen = context.selection->bone;
  const bool has_bone = chosen && *chosen < std::ssize(rig->bones);
  if (column.begin_section("Clinical angles", has_bone ? rig->bones[static_cast<std::size_t>(*chosen)].name : "")) {
    column.space(6);
    const std::vector<SidedJoint> shown = has_bone ? joints_of_bone(frames, *chosen) : std::vector<SidedJoint>();
    draw_choice(context, column, joints, shown);
    const JointAngles angles = clinical_angles(*rig, frames, shown_pose(context));
    for (const SidedJoint& joint : shown) draw_joint(context, column, joint, angles.at(joint));
    if (!shown.empty() && (shown.back().joint == BodyJoint::Wrist || is_finger(shown.back().joint)))
      if (const HandShape shape = hand_shape(angles, shown.back().side); shape.curl)
        draw_hand(context, column, shown.back().side, shape);
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
