// SPDX-License-Identifier: AGPL-3.0-or-later
// Applies a clip's constraints to the pose of a frame.
//
// They are applied in the list's order, except that a constraint waits for those that turn its target, or a bone above
// the bones that it turns: a hand is planted on the hip after the hip has its rotation. Where two constraints turn the
// same bone, the later one has the last word: it waits for the earlier one too, unless that would wait for it in turn.
// Constraints that must wait for each other in a circle have no order. They are not applied, and problem() says so; so
// are those whose bones the rig does not have. One that is switched off keeps no other waiting.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/motion/constraint_rule.h"

namespace limber {

class ConstraintStack {
 public:
  ConstraintStack(std::shared_ptr<const Constraints> constraints, std::shared_ptr<const Armature> armature);

  // Returns the pose in which the constraints hold, each by its weight at the frame.
  //   keys  those of the clip, for the weights
  Pose constrained(const Pose& pose, const Keys& keys, int frame) const;

  // Returns why a constraint is not applied: one line; empty if it is.
  //   index  in the list of constraints
  std::string problem(std::size_t index) const { return problems_[index] ? problems_[index]->what() : ""; }
  // Throws that problem, if there is one.
  void require_applied(std::size_t index) const;
  // Returns the indices of the constraints that are applied, in the order in which they are.
  const std::vector<std::size_t>& order() const { return order_; }
  // Returns a constraint with its bones; nothing where the rig does not have them.
  const std::optional<ConstraintOnRig>& found(std::size_t index) const { return found_[index]; }
  // Returns the bones that a constraint turns; empty if it is not applied.
  const std::vector<int>& turned(std::size_t index) const { return turned_[index]; }
  const std::shared_ptr<const Constraints>& constraints() const { return constraints_; }
  const std::shared_ptr<const Armature>& armature() const { return armature_; }

 private:
  void find_order();
  // Leaves out constraints that wait for each other: each for the next one, and the last is the first again.
  void leave_out(const std::vector<std::size_t>& circle);

  std::shared_ptr<const Constraints> constraints_;
  std::shared_ptr<const Armature> armature_;
  std::vector<std::optional<Error>> problems_;
  std::vector<std::optional<ConstraintOnRig>> found_;
  std::vector<std::vector<int>> turned_;
  std::vector<std::size_t> order_;
};

}  // namespace limber
