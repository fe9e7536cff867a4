// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/motion/constraint_panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "editor/context/context.h"
#include "editor/context/field_edit.h"
#include "editor/context/operator.h"
#include "editor/context/operator_button.h"
#include "editor/context/selection.h"
#include "editor/motion/constraint_edits.h"
#include "editor/motion/timeline.h"
#include "editor/shown/shown_pose.h"
#include "editor/ui/axis_fields.h"
#include "editor/ui/icons.h"
#include "editor/ui/input_fields.h"

namespace limber::editor {

namespace {

constexpr double kFar = 1e5;          // a coordinate beyond plus or minus this cannot be typed, mm
constexpr double kWidestLimit = 180;  // a rotation limit beyond plus or minus this cannot be typed, degrees
constexpr int kLongestChain = 64;

// A number field of the panel that shows and changes one number of a constraint.
struct Number {
  std::string name;  // name of the field, different from that of every other number field of the window
  double shown = 0, low = 0, high = 1;
  const char *format = "%.1f", *unit = "";
  bool filled = false;
  std::function<void(Context&, double)> preview, commit;
};

// Draws the number field. While the user edits the number, the views show the changed pose; when the user has finished,
// one edit is committed.
void draw_number(Context& context, const Rect& rect, const Number& number) {
  auto& edited = context.field_edit->number;
  double value = edited.name == number.name ? edited.value : number.shown;
  bool committed = false;
  if (number_field(context.ui, number.name, rect, value, number.low, number.high, number.format, number.unit,
                   number.filled, committed)) {
    edited = {number.name, value};
    number.preview(context, value);
  }
  if (!committed || edited.name != number.name) return;
  const double wanted = edited.value;
  edited = {};
  attempt(context, "Constraint", [&](Context& c) { number.commit(c, wanted); });
}

// Returns the number field for a setting of the constraint, such as a coordinate of its target position.
Number number_of(const Constraint& constraint, const std::string& name, const std::string& label, double shown,
                 const std::function<void(Constraint&, double)>& set) {
  Number number{.name = constraint.name + " " + name, .shown = shown};
  number.preview = [=, who = constraint.name](Context& c, double value) {
    preview_constraint(c, who, [&](Constraint& changed) { set(changed, value); });
  };
  number.commit = [=, who = constraint.name](Context& c, double value) {
    change_constraint(c, who, label, [&](Constraint& changed) { set(changed, value); });
  };
  return number;
}

void change(Context& context, const Constraint& constraint, const std::string& label,
            const std::function<void(Constraint&)>& set) {
  const std::string name = constraint.name;
  attempt(context, label, [&](Context& c) { change_constraint(c, name, label, set); });
}

// Draws a list field whose choices are the values of an enum. Returns true when the user selected another choice.
bool choose(Context& context, Column& column, const std::string& title, const std::vector<std::string>& words,
            int& chosen) {
  const PathScope path(context.ui, title);
  return choice_field(context.ui, column.property(title), words, chosen);
}

bool draw_small_icon(Ui& ui, const Rect& rect, const std::string& name, const char* picture, Colour colour,
                     const std::string& title, const std::string& help) {
  const Pressed pressed = press_area(ui, name, rect);
  put_icon(ui.look.fonts.regular, pressed.hovered ? ui.look.theme.text : colour, rect, picture);
  if (pressed.hovered) tooltip(ui, rect, title, help);
  return pressed.clicked;
}

// Of the constraints that turn a bone which this constraint turns too: the nearest before it in the list ([0]) and the
// nearest after it ([1]); null if there is none.
using OrderNeighbours = std::array<const Constraint*, 2>;

// Draws the up and down buttons that move a constraint in the list. Returns true if one was clicked.
bool draw_order(Context& context, const Rect& rect, const Constraint& constraint, const OrderNeighbours& others) {
  const Look& look = context.ui->look;
  const std::string name = constraint.name;
  for (const InOrder where : {InOrder::Earlier, InOrder::Later}) {
    const bool earlier = where == InOrder::Earlier;
    const Constraint* other = others[earlier ? 0 : 1];
    const float middle = std::round(rect.centre().x);
    const Rect place = earlier ? Rect{rect.low, {middle, rect.high.y}} : Rect{{middle, rect.low.y}, rect.high};
    if (!other) {
      put_icon(look.fonts.regular, look.theme.text3, place, earlier ? icon::kUp : icon::kDown);
      continue;
    }
    if (!draw_small_icon(context.ui, place, earlier ? "Up" : "Down", earlier ? icon::kUp : icon::kDown,
                         look.theme.text2, std::string("Apply ") + (earlier ? "before " : "after ") + other->name,
                         "Both constraints turn the same bones. The constraint applied later decides the rotation."))
      continue;
    attempt(context, "Move constraint", [&](Context& c) { move_constraint(c, name, where); });
    return true;
  }
  return false;
}

// Draws the header row of a constraint. Returns false if one of its buttons has changed the document.
bool draw_head(Context& context, Column& column, const Constraint& constraint, bool is_open, bool has_problem) {
  const Look& look = context.ui->look;
  const Rect row = column.row(26);
  const float left = row.low.x + look.px(10), right = row.high.x - look.px(10), side = look.px(20);
  OrderNeighbours others{};
  if (is_open)
    others = {order_neighbour(context, constraint.name, InOrder::Earlier),
              order_neighbour(context, constraint.name, InOrder::Later)};
  const bool has_order = others[0] || others[1];
  const Rect order{{right - 4 * side, row.low.y}, {right - 2 * side, row.high.y}};
  if (has_order && draw_order(context, order, constraint, others)) return false;
  const Rect fold{{left, row.low.y}, {has_order ? order.low.x : order.high.x, row.high.y}};
  const Pressed pressed = press_area(context.ui, "Fold", fold);
  put_icon(look.fonts.regular, look.theme.text2, Rect{fold.low, {left + look.px(14), row.high.y}},
           is_open ? icon::kOpened : icon::kClosed);
  const Colour colour = has_problem ? look.theme.warn : constraint.on ? look.theme.text : look.theme.text3;
  put_text(context.ui, is_open ? look.fonts.semibold : look.fonts.regular, colour,
           Rect{{left + look.px(18), row.low.y}, fold.high}, constraint.name);
  if (pressed.hovered) tooltip(context.ui, fold, constraint.name, constraint_rule(constraint.kind).description);
  if (pressed.clicked) context.timeline->constraint = is_open ? "" : constraint.name;
  if (draw_small_icon(context.ui, {{right - 2 * side, row.low.y}, {right - side, row.high.y}}, "On",
                      constraint.on ? icon::kVisible : icon::kHidden,
                      constraint.on ? look.theme.text2 : look.theme.text3,
                      constraint.on ? "Switch constraint off" : "Switch constraint on",
                      "A constraint that is switched off changes nothing.")) {
    change(context, constraint, constraint.on ? "Switch constraint off" : "Switch constraint on",
           [](Constraint& changed) { changed.on = !changed.on; });
    return false;
  }
  if (!draw_small_icon(context.ui, {{right - side, row.low.y}, {right, row.high.y}}, "Remove", icon::kClose,
                       look.theme.text3, "Remove constraint", "Remove the constraint and the keys of its weight."))
    return true;
  const std::string name = constraint.name;
  attempt(context, "Remove constraint", [&](Context& c) { remove_constraint(c, name); });
  return false;
}

void draw_weight(Context& context, Column& column, const Constraint& constraint) {
  const Look& look = context.ui->look;
  const Rect rect = column.property("Weight");
  const float button = look.px(22);
  Number number{.name = constraint.name + " weight",
                .shown = shown_weight(context, constraint),
                .format = "%.2f",
                .filled = true};
  number.preview = [who = constraint.name](Context& c, double value) { preview_weight(c, who, value); };
  number.commit = [who = constraint.name](Context& c, double value) { set_weight(c, who, value); };
  const bool is_keyed = shown_clip(context.document())->keys.weights.contains(constraint.name);
  const bool is_here = has_weight_key(context.document(), constraint, shown_frame(context));
  draw_number(context, {rect.low, {rect.high.x - button - look.px(4), rect.high.y}}, number);
  if (!find_constraint(context.document(), constraint.name)) return;
  const Rect key{{rect.high.x - button, rect.low.y}, rect.high};
  const std::string name = constraint.name;
  if (draw_small_icon(context.ui, key, "Key weight", icon::kKey,
                      is_here    ? look.theme.select
                      : is_keyed ? look.theme.accent_text
                                 : look.theme.text3,
                      is_here ? "Delete weight key" : "Key weight",
                      "The weight is interpolated between its keys. At 0 the bone has its keyed pose, at 1 the pose "
                      "that the constraint sets."))
    attempt(context, "Key weight", [&](Context& c) { toggle_weight_key(c, name); });
  if (!is_keyed) return;
  const auto& track = shown_clip(context.document())->keys;
  const auto shapes = track.weight_shapes.find(name);
  int chosen = static_cast<int>(shapes == track.weight_shapes.end() || shapes->second.empty()
                                    ? Interpolation::Linear
                                    : shapes->second.begin()->second.next);
  if (choose(context, column, "Interpolation", {"Constant", "Linear", "Smooth"}, chosen))
    set_weight_steps(context, name, static_cast<Interpolation>(chosen));
}

void draw_target(Context& context, Column& column, const Constraint& constraint) {
  const Armature& rig = *context.document().armature;
  const bool may_be_world = constraint_rule(constraint.kind).target == ConstraintTarget::Place;
  std::vector<std::string> names;
  if (may_be_world) names.push_back("World");
  int chosen = 0;
  for (const Bone& bone : rig.bones) {
    if (bone.name == constraint.target) chosen = static_cast<int>(names.size());
    names.push_back(bone.name);
  }
  if (!choose(context, column, "Target", names, chosen)) return;
  const std::string name = constraint.name,
                    bone = may_be_world && chosen == 0 ? "" : names[static_cast<std::size_t>(chosen)];
  attempt(context, "Set target", [&](Context& c) { set_target(c, name, bone); });
}

// Draws three numbers in one row.
void draw_three(Context& context, Column& column, const std::string& title, const std::array<Number, 3>& numbers) {
  const std::array<Rect, 3> fields = lay_axis_fields(context.ui->look, column, title);
  for (std::size_t axis = 0; axis < 3; ++axis) draw_number(context, fields[axis], numbers[axis]);
}

void draw_place(Context& context, Column& column, const Constraint& constraint) {
  std::array<Number, 3> numbers;
  for (int axis = 0; axis < 3; ++axis) {
    Number& number = numbers[static_cast<std::size_t>(axis)];
    number = number_of(constraint, std::string("place ") + "XYZ"[axis], "Move target", constraint.place[axis],
                       [axis](Constraint& changed, double value) { changed.place[axis] = value; });
    number.low = -kFar;
    number.high = kFar;
  }
  draw_three(context, column, "Position, mm", numbers);
}

void draw_axes(Context& context, Column& column, const Constraint& constraint) {
  const Rect rect = column.property("Local axes");
  const float width = rect.width() / 3;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bool on = constraint.axes[axis];
    const float x = std::round(rect.low.x + static_cast<float>(axis) * width);
    const std::string label(1, "XYZ"[axis]);
    if (checkbox(context.ui, "Axis " + label, {{x, rect.low.y}, {x + width, rect.high.y}}, label, on))
      change(context, constraint, "Set local axes", [axis, on](Constraint& changed) { changed.axes[axis] = on; });
  }
}

void draw_limits(Context& context, Column& column, const Constraint& constraint) {
  for (const bool is_maximum : {false, true}) {
    std::array<Number, 3> numbers;
    for (int axis = 0; axis < 3; ++axis) {
      const double shown = glm::degrees((is_maximum ? constraint.maximum : constraint.minimum)[axis]);
      Number& number = numbers[static_cast<std::size_t>(axis)];
      number = number_of(constraint, (is_maximum ? "maximum " : "minimum ") + std::string(1, "XYZ"[axis]), "Set limits",
                         shown, [=](Constraint& changed, double degrees) {
                           const double angle = glm::radians(degrees);
                           // The minimum must not exceed the maximum, so the other limit moves with the changed one.
                           if (is_maximum) changed.minimum[axis] = std::min(changed.minimum[axis], angle);
                           else changed.maximum[axis] = std::max(changed.maximum[axis], angle);
                           (is_maximum ? changed.maximum : changed.minimum)[axis] = angle;
                         });
      number.low = -kWidestLimit;
      number.high = kWidestLimit;
    }
    draw_three(context, column, is_maximum ? "Maximum, \u00b0" : "Minimum, \u00b0", numbers);
  }
}

void draw_aim(Context& context, Column& column, const Constraint& constraint) {
  int chosen = static_cast<int>(constraint.aim);
  if (choose(context, column, "Aim axis", {"+X", "-X", "+Y (along)", "-Y", "+Z", "-Z"}, chosen))
    change(context, constraint, "Set aiming axis",
           [chosen](Constraint& changed) { changed.aim = static_cast<BoneAxis>(chosen); });
}

// Returns true if the planted limb ends in a hand or foot. Otherwise the panel does not offer the planted point and
// the direction: a forearm or shank alone can be planted only at its tail.
bool ends_in_hand_or_foot(Context& context, const Constraint& constraint) {
  const ClipOnRig* clip = clip_on_rig(context);
  const ConstraintStack* stack = clip ? clip->constraints() : nullptr;
  for (std::size_t i = 0; stack && i < stack->constraints()->list.size(); ++i)
    if (stack->constraints()->list[i].name == constraint.name)
      return stack->found(i) && has_planted_end(*stack->found(i));
  return false;
}

void draw_plant(Context& context, Column& column, const Constraint& constraint) {
  if (!ends_in_hand_or_foot(context, constraint)) return;
  const std::string name = constraint.name;
  int point = static_cast<int>(constraint.point);
  if (choose(context, column, "Planted point", {"Joint", "Tip"}, point)) {
    attempt(context, "Set planted point",
            [&](Context& c) { set_planted_point(c, name, static_cast<PlantPoint>(point)); });
    return;
  }
  bool keeps = constraint.keeps_rotation;
  if (checkbox(context.ui, "Keep direction", column.property("Direction"), "Keep", keeps))
    attempt(context, "Keep direction", [&](Context& c) { keep_direction(c, name, keeps); });
}

void draw_inverse_kinematics(Context& context, Column& column, const Constraint& constraint) {
  Number chain =
      number_of(constraint, "chain", "Set chain length", constraint.chain,
                [](Constraint& changed, double bones) { changed.chain = static_cast<int>(std::lround(bones)); });
  chain.high = kLongestChain;
  chain.format = "%.0f";
  chain.unit = constraint.chain == 0 ? "(to the root)" : constraint.chain == 1 ? "bone" : "bones";
  draw_number(context, column.property("Chain length"), chain);
  bool keeps = constraint.keep_limits;
  if (checkbox(context.ui, "Joint limits", column.property("Joint limits"), "Keep", keeps))
    change(context, constraint, "Keep joint limits", [keeps](Constraint& changed) { changed.keep_limits = keeps; });
}

void draw_copy(Context& context, Column& column, const Constraint& constraint) {
  int space = static_cast<int>(constraint.space);
  if (choose(context, column, "Rotation", {"World space", "Parent space"}, space))
    return change(context, constraint, "Set rotation space",
                  [space](Constraint& changed) { changed.space = static_cast<RotationSpace>(space); });
  draw_axes(context, column, constraint);
}

void draw_settings(Context& context, Column& column, const Constraint& constraint) {
  switch (constraint.kind) {
    case ConstraintKind::CopyRotation: return draw_copy(context, column, constraint);
    case ConstraintKind::LimitRotation:
      draw_axes(context, column, constraint);
      return draw_limits(context, column, constraint);
    case ConstraintKind::JointRange: return;
    case ConstraintKind::Aim: return draw_aim(context, column, constraint);
    case ConstraintKind::Plant: return draw_plant(context, column, constraint);
    case ConstraintKind::InverseKinematics: return draw_inverse_kinematics(context, column, constraint);
  }
}

void draw_one(Context& context, Column& column, const Constraint& constraint, const std::string& problem) {
  const Look& look = context.ui->look;
  const PathScope path(context.ui, constraint.name);
  const bool is_open = context.timeline->constraint == constraint.name;
  if (!draw_head(context, column, constraint, is_open, !problem.empty())) return;
  if (!is_open) return;
  if (!problem.empty()) {
    const float width = column.row(0).width() - look.px(20);
    const Rect row = column.row(height_of_wrapped(look.fonts.small, problem, width, 3) / look.scale + 6);
    put_wrapped(context.ui, look.fonts.small, look.theme.warn, {row.low.x + look.px(10), row.low.y}, width, problem, 3);
  }
  const ConstraintTarget needed = constraint_rule(constraint.kind).target;
  draw_weight(context, column, constraint);
  if (needed != ConstraintTarget::None) draw_target(context, column, constraint);
  if (needed == ConstraintTarget::Place) draw_place(context, column, constraint);
  draw_settings(context, column, constraint);
  column.space(6);
}

}  // namespace

void draw_constraints(Context& context, Column& column) {
  const std::shared_ptr<const Armature> rig = context.document().armature;
  const auto bone = context.selection->bone;
  const bool has_bone = rig && bone && *bone < std::ssize(rig->bones);
  // Constraints whose bone the rig no longer has are listed for every active bone, and without an active bone.
  // Otherwise the user could not select them.
  std::vector<std::size_t> indices = constraints_of_no_bone(context.document());
  if (!has_bone && indices.empty()) return;
  const Look& look = context.ui->look;
  if (has_bone) {
    const std::vector<std::size_t> own = constraints_of_bone(context.document(), *bone);
    indices.insert(indices.begin(), own.begin(), own.end());
  }
  if (column.begin_section("Constraints", indices.empty() ? "" : std::to_string(indices.size()))) {
    column.space(4);
    // The list is copied, because a field that is drawn below may replace the document.
    const Constraints constraints = constraints_of(context.document());
    for (const std::size_t index : indices) {
      const ClipOnRig* clip = clip_on_rig(context);
      const std::string problem = clip && clip->constraints() && clip->constraints()->constraints()->list.size() > index
                                      ? clip->constraints()->problem(index)
                                      : "";
      draw_one(context, column, constraints.list[index], problem);
    }
    if (has_bone) {
      const Rect row = column.row(30);
      operator_button(
          context, "constraint.add",
          {{row.low.x + look.px(10), row.low.y + look.px(2)}, {row.high.x - look.px(10), row.high.y - look.px(2)}},
          "Add constraint");
    }
    column.space(6);
  }
  column.end_section();
}

}  // namespace limber::editor
