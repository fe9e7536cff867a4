// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of the shown clip's constraints (core/motion/constraint.h). The changed constraints hold at once in the
// document's pose, and what the user has changed in it by hand stays. A pose that no clip makes, because the rig was
// only posed by hand, is keyed when the first constraint is added: else it would be lost.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/motion/constraint_stack.h"
#include "editor/motion/timeline.h"

namespace limber::editor {

// Returns the constraints of the shown clip; an empty list if it has none.
const Constraints& constraints_of(const Document& document);
// Returns the indices of a bone's constraints in that list.
std::vector<std::size_t> constraints_of_bone(const Document& document, int bone);
// Returns the indices of those whose bone the rig no longer has.
std::vector<std::size_t> constraints_of_no_bone(const Document& document);
// Returns the constraint that operators change: the one of the active bone that is unfolded, or its first one; nullptr
// if the bone has none.
const Constraint* active_constraint(const Editor& editor);
const Constraint* find_constraint(const Document& document, const std::string& name);

// Adds a constraint to the active bone. If one other bone is selected, it is the target, else the target is a place of
// the world: a hand stays where it is. Throws Error with one line if it cannot be.
void add_constraint(Editor& editor, ConstraintKind kind);
void remove_constraint(Editor& editor, const std::string& name);
// Returns the nearest earlier or later constraint past which a move of the named one changes the order in which those
// are applied that turn the same bones: of two such, the later one has the last word, unless the first must wait for it
// (core/motion/constraint_stack.h). Of constraints that are switched off, what holds once they are on. nullptr: none.
enum class InOrder { Earlier, Later };
const Constraint* order_neighbour(const Editor& editor, const std::string& name, InOrder where);
// Moves a constraint in the list, before its earlier neighbour or after its later one. Does nothing without one.
void move_constraint(Editor& editor, const std::string& name, InOrder where);
// Throws Error if the changed constraint could not be applied, such as for a circle of targets.
void change_constraint(Editor& editor, const std::string& name, const std::string& label,
                       const std::function<void(Constraint&)>& change);
// Shows the pose with the changed constraint, without an edit.
void preview_constraint(Editor& editor, const std::string& name, const std::function<void(Constraint&)>& change);
// Makes a bone the target, or with "" a place of the world. What is planted stays where it is now.
void set_target(Editor& editor, const std::string& name, const std::string& bone);
// Chooses the point of a planted hand or foot that stays, or whether its direction does. Both are then as they are now.
void set_planted_point(Editor& editor, const std::string& name, PlantPoint point);
void keep_direction(Editor& editor, const std::string& name, bool keeps);
void aim_at_cross_hair(Editor& editor, const std::string& name);

// ---- Weights
bool has_weight_key(const Editor& editor, const Constraint& constraint, int frame);
// Returns the weight at the shown frame.
double shown_weight(const Editor& editor, const Constraint& constraint);
// Sets the weight: where it has keys, that of the shown frame.
void set_weight(Editor& editor, const std::string& name, double weight);
void preview_weight(Editor& editor, const std::string& name, double weight);
void toggle_weight_key(Editor& editor, const std::string& name);
// Keys the weight as it is at the shown frame, and the opposite one a third of a second later: 0 after more than a
// half, else 1. Keys between these two go.
void switch_weight(Editor& editor, const std::string& name);
void set_weight_steps(Editor& editor, const std::string& name, Interpolation next);

// Bakes all constraints of the clip into keys, in the background.
void apply_constraints(Editor& editor);

}  // namespace limber::editor
