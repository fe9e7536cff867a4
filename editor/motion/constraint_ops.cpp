// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of constraints: for each kind of constraint an operator that adds one, and operators that change the active
// bone's constraint.
#include "core/project/job.h"
#include "editor/context/context.h"
#include "editor/context/menu_state.h"
#include "editor/context/operator.h"
#include "editor/context/operator_polls.h"
#include "editor/context/workspace.h"
#include "editor/motion/constraint_edits.h"
#include "editor/motion/timeline.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_pose_bone(const Context& context) {
  if (context.workspace() != Workspace::Pose) return "Switch to the Pose workspace first";
  return needs_bone(context);
}

std::string needs_constraint(const Context& context) {
  if (const std::string why = needs_pose_bone(context); !why.empty()) return why;
  return active_constraint(context) ? "" : "The active bone has no constraint: add a constraint first";
}

std::string needs_place(const Context& context) {
  if (const std::string why = needs_constraint(context); !why.empty()) return why;
  return constraint_rule(active_constraint(context)->kind).target == ConstraintTarget::Place
             ? ""
             : "This command needs a constraint whose target is a position";
}

std::string needs_any_constraint(const Context& context) {
  if (!context.document().armature) return "Import a rig first";
  return constraints_of(context.document()).list.empty() ? "The clip has no constraints: add a constraint first" : "";
}

// Returns the label of the operator that adds a constraint of this kind, such as "Add copy rotation".
std::string adding(const ConstraintRule& rule) {
  std::string name = rule.name;
  if (name[0] >= 'A' && name[0] <= 'Z') name[0] = static_cast<char>(name[0] - 'A' + 'a');
  return "Add " + name;
}

std::function<std::string(const Context&)> needs_neighbour(InOrder where) {
  return [where](const Context& context) -> std::string {
    if (std::string why = needs_constraint(context); !why.empty()) return why;
    if (order_neighbour(context, active_constraint(context)->name, where)) return "";
    return std::string("The constraint cannot move ") + (where == InOrder::Earlier ? "up" : "down") +
           ": its order among the constraints that turn its bones would stay the same";
  };
}

// Returns an operator's function that applies `edit` to the active bone's constraint.
template <class Edit>
std::function<void(Context&)> of_active(Edit edit) {
  return [edit](Context& context) {
    if (const Constraint* constraint = active_constraint(context)) edit(context, std::string(constraint->name));
  };
}

void toggle(Context& context, const std::string& name) {
  const bool on = find_constraint(context.document(), name)->on;
  change_constraint(context, name, on ? "Switch constraint off" : "Switch constraint on",
                    [on](Constraint& constraint) { constraint.on = !on; });
}

}  // namespace

std::vector<Operator> constraint_operators() {
  std::vector<Operator> operators = {
      {"constraint.add", "Add constraint", icon::kAdd, "Motion",
       "Open a menu of constraints for the active bone. A second selected bone is the target.",
       [](Context& c) { c.menus->open_popup = "Add constraint"; }, needs_pose_bone},
  };
  for (const ConstraintRule& rule : constraint_rules()) {
    const bool has_target = rule.target != ConstraintTarget::None;
    operators.push_back({"constraint.add_" + rule.id, adding(rule), "", "Motion",
                         rule.description + (has_target ? " A second selected bone is the target." : ""),
                         [kind = rule.kind](Context& c) { add_constraint(c, kind); }, needs_pose_bone});
  }
  const std::vector<Operator> others = {
      {"constraint.remove", "Remove constraint", "", "Motion",
       "Remove the active bone's constraint and the keys of its weight.", of_active(remove_constraint),
       needs_constraint},
      {"constraint.toggle", "Toggle constraint", "", "Motion", "Switch the active bone's constraint on or off.",
       of_active(toggle), needs_constraint,
       [](const Context& c) { return active_constraint(c) && active_constraint(c)->on; }},
      {"constraint.up", "Move constraint up", icon::kUp, "Motion",
       "Move the active bone's constraint before the previous one that turns the same bones. The constraint applied "
       "last decides the rotation.",
       of_active([](Context& c, const std::string& name) { move_constraint(c, name, InOrder::Earlier); }),
       needs_neighbour(InOrder::Earlier)},
      {"constraint.down", "Move constraint down", icon::kDown, "Motion",
       "Move the active bone's constraint after the next one that turns the same bones. The constraint applied last "
       "decides the rotation.",
       of_active([](Context& c, const std::string& name) { move_constraint(c, name, InOrder::Later); }),
       needs_neighbour(InOrder::Later)},
      {"constraint.key_weight", "Key constraint weight", icon::kKey, "Motion",
       "Insert or delete a key of the constraint's weight at this frame.", of_active(toggle_weight_key),
       needs_constraint,
       [](const Context& c) {
         const Constraint* constraint = active_constraint(c);
         return constraint && has_weight_key(c.document(), *constraint, shown_frame(c));
       }},
      {"constraint.switch", "Switch IK and FK", "", "Motion",
       "Key the weight at this frame, and the opposite weight a third of a second later, to fade the constraint in or "
       "out.",
       of_active(switch_weight), needs_constraint},
      {"constraint.to_cross_hair", "Target to cross-hair", icon::kCrossHair, "Motion",
       "Move the target of the active bone's constraint to the cross-hair.", of_active(aim_at_cross_hair), needs_place},
      {"constraint.apply", "Apply constraints", "", "Motion",
       "Bake all constraints of the clip into keys, one in each frame. The animation does not change.",
       apply_constraints, needs_any_constraint},
  };
  operators.insert(operators.end(), others.begin(), others.end());
  return operators;
}

}  // namespace limber::editor
