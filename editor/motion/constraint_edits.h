// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the shown clip's constraints (core/motion/constraint.h). The document's pose fulfils the changed
// constraints at once and keeps what the user has changed by hand. If the user has posed the rig without a clip, the
// pose is keyed when the first constraint is added, because it would be lost otherwise.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/motion/constraint_stack.h"
#include "core/project/document.h"

namespace limber::editor {

struct Context;

// Returns the constraints of the shown clip; an empty list if it has none.
const Constraints& constraints_of(const Document& document);
// Returns the indices of a bone's constraints in the list constraints_of().
std::vector<std::size_t> constraints_of_bone(const Document& document, int bone);
// Returns the indices of the constraints whose bone the rig no longer has.
std::vector<std::size_t> constraints_of_no_bone(const Document& document);
// Returns the constraint that operators change: the constraint of the active bone that is unfolded in the panel, or
// else the bone's first constraint; nullptr if the bone has none.
const Constraint* active_constraint(const Context& context);
const Constraint* find_constraint(const Document& document, const std::string& name);

// Adds a constraint to the active bone. If exactly one other bone is selected, that bone is the target. Otherwise the
// target is a fixed position in the world, where the bone is now. Throws Error if the constraint cannot be added.
void add_constraint(Context& context, ConstraintKind kind);
void remove_constraint(Context& context, const std::string& name);
// Returns the nearest earlier or later constraint that turns a bone which the named constraint turns too, and past
// which the named constraint can be moved; nullptr if there is none. If two constraints turn the same bone, the
// constraint that is applied later decides the bone's final rotation. Constraints are applied in the order of the list,
// unless one constraint depends on the other (core/motion/constraint_stack.h). Disabled constraints are treated as if
// they were enabled.
enum class InOrder { Earlier, Later };
const Constraint* order_neighbour(const Context& context, const std::string& name, InOrder where);
// Moves a constraint in the list: before the constraint that order_neighbour() returns for Earlier, or after the one
// for Later. Does nothing if there is no such constraint.
void move_constraint(Context& context, const std::string& name, InOrder where);
// Changes a constraint as one edit. Throws Error if the changed constraint cannot be applied, for example because
// constraints would target each other in a circle.
void change_constraint(Context& context, const std::string& name, const std::string& label,
                       const std::function<void(Constraint&)>& change);
// Shows the pose with the changed constraint, without changing the document.
void preview_constraint(Context& context, const std::string& name, const std::function<void(Constraint&)>& change);
// Makes a bone the target of a constraint. If `bone` is "", the target becomes a fixed position in the world. The
// current position of a planted hand or foot does not change.
void set_target(Context& context, const std::string& name, const std::string& bone);
// Sets which point of a hand or foot the constraint plants, and whether its direction is fixed too. The target becomes
// the current position and direction of that point.
void set_planted_point(Context& context, const std::string& name, PlantPoint point);
void keep_direction(Context& context, const std::string& name, bool keeps);
void aim_at_cross_hair(Context& context, const std::string& name);

// ---- Weights of constraints
bool has_weight_key(const Document& document, const Constraint& constraint, int frame);
// Returns the constraint's weight at the shown frame.
double shown_weight(const Context& context, const Constraint& constraint);
// Sets a constraint's weight. If the weight has keys, sets a key at the shown frame.
void set_weight(Context& context, const std::string& name, double weight);
void preview_weight(Context& context, const std::string& name, double weight);
void toggle_weight_key(Context& context, const std::string& name);
// Keys the current weight at the shown frame, and the opposite weight a third of a second later: 0 if the current
// weight is above 0.5, otherwise 1. Deletes the weight keys between these two.
void switch_weight(Context& context, const std::string& name);
void set_weight_steps(Context& context, const std::string& name, Interpolation next);

// Bakes all constraints of the clip into keys in a background task.
void apply_constraints(Context& context);

}  // namespace limber::editor
