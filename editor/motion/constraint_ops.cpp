// SPDX-License-Identifier: AGPL-3.0-or-later
// Operators of constraints: one for each kind that adds a constraint, and those that change the active bone's
// constraint.
#include "editor/context/operator_polls.h"
#include "editor/motion/constraint_edits.h"
#include "editor/ui/icons.h"

namespace limber::editor {

namespace {

std::string needs_pose_bone(const Editor& editor) {
  if (editor.workspace != Workspace::Pose) return "Switch to the Pose workspace first";
  return needs_bone(editor);
}

std::string needs_constraint(const Editor& editor) {
  if (const std::string why = needs_pose_bone(editor); !why.empty()) return why;
  return active_constraint(editor) ? "" : "The active bone has no constraint";
}

std::string needs_place(const Editor& editor) {
  if (const std::string why = needs_constraint(editor); !why.empty()) return why;
  return constraint_rule(active_constraint(editor)->kind).target == ConstraintTarget::Place
             ? ""
             : "The constraint's target is not a position";
}

std::string needs_any_constraint(const Editor& editor) {
  if (!editor.document().armature) return "Import a rig first";
  return constraints_of(editor.document()).list.empty() ? "The clip has no constraints" : "";
}

// Returns the label of the operator that adds a constraint of a kind: "Add copy rotation".
std::string adding(const ConstraintRule& rule) {
  std::string name = rule.name;
  if (name[0] >= 'A' && name[0] <= 'Z') name[0] = static_cast<char>(name[0] - 'A' + 'a');
  return "Add " + name;
}

std::function<std::string(const Editor&)> needs_neighbour(InOrder where) {
  return [where](const Editor& editor) -> std::string {
    if (std::string why = needs_constraint(editor); !why.empty()) return why;
    if (order_neighbour(editor, active_constraint(editor)->name, where)) return "";
    return std::string("The constraint cannot move ") + (where == InOrder::Earlier ? "up" : "down") +
           ": this would not change the order in which constraints turn the same bones";
  };
}

// Returns an operator's function that applies `edit` to the active bone's constraint.
template <class Edit>
std::function<void(Editor&)> of_active(Edit edit) {
  return [edit](Editor& editor) {
    if (const Constraint* constraint = active_constraint(editor)) edit(editor, std::string(constraint->name));
  };
}

void toggle(Editor& editor, const std::string& name) {
  const bool on = find_constraint(editor.document(), name)->on;
  change_constraint(editor, name, on ? "Switch constraint off" : "Switch constraint on",
                    [on](Constraint& constraint) { constraint.on = !on; });
}

}  // namespace

std::vector<Operator> constraint_operators() {
  std::vector<Operator> operators = {
      {"constraint.add", "Add constraint", icon::kAdd, "Motion",
       "Open a menu of constraints for the active bone. A second selected bone is the target.",
       [](Editor& e) { e.open_popup = "Add constraint"; }, needs_pose_bone},
  };
  for (const ConstraintRule& rule : constraint_rules()) {
    const bool has_target = rule.target != ConstraintTarget::None;
    operators.push_back({"constraint.add_" + rule.id, adding(rule), "", "Motion",
                         rule.description + (has_target ? " A second selected bone is the target." : ""),
                         [kind = rule.kind](Editor& e) { add_constraint(e, kind); }, needs_pose_bone});
  }
  const std::vector<Operator> others = {
      {"constraint.remove", "Remove constraint", "", "Motion",
       "Remove the active bone's constraint and the keys of its weight.", of_active(remove_constraint),
       needs_constraint},
      {"constraint.toggle", "Toggle constraint", "", "Motion", "Switch the active bone's constraint on or off.",
       of_active(toggle), needs_constraint,
       [](const Editor& e) { return active_constraint(e) && active_constraint(e)->on; }},
      {"constraint.up", "Move constraint up", icon::kUp, "Motion",
       "Move the active bone's constraint before the previous one that turns the same bones. The constraint applied "
       "last decides the rotation.",
       of_active([](Editor& e, const std::string& name) { move_constraint(e, name, InOrder::Earlier); }),
       needs_neighbour(InOrder::Earlier)},
      {"constraint.down", "Move constraint down", icon::kDown, "Motion",
       "Move the active bone's constraint after the next one that turns the same bones. The constraint applied last "
       "decides the rotation.",
       of_active([](Editor& e, const std::string& name) { move_constraint(e, name, InOrder::Later); }),
       needs_neighbour(InOrder::Later)},
      {"constraint.key_weight", "Key constraint weight", icon::kKey, "Motion",
       "Insert or delete a key of the constraint's weight at this frame.", of_active(toggle_weight_key),
       needs_constraint,
       [](const Editor& e) {
         const Constraint* constraint = active_constraint(e);
         return constraint && has_weight_key(e, *constraint, shown_frame(e));
       }},
      {"constraint.switch", "Switch IK and FK", "", "Motion",
       "Key the weight at this frame, and the opposite weight a third of a second later, to fade the constraint in or "
       "out.",
       of_active(switch_weight), needs_constraint},
      {"constraint.to_cross_hair", "Target at cross-hair", icon::kCrossHair, "Motion",
       "Move the target of the active bone's constraint to the cross-hair.", of_active(aim_at_cross_hair), needs_place},
      {"constraint.apply", "Apply constraints", "", "Motion",
       "Bake all constraints of the clip into keys, one in each frame. The animation does not change.",
       apply_constraints, needs_any_constraint},
  };
  operators.insert(operators.end(), others.begin(), others.end());
  return operators;
}

}  // namespace limber::editor
