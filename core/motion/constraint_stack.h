// SPDX-License-Identifier: AGPL-3.0-or-later
// Applies a clip's constraints to the pose of a frame.
//
// Constraints are applied in the list's order, with one exception: a constraint waits for those that turn its target or
// a parent of the bones that it turns. For example, a hand is planted on the hip after the hip has its rotation. If two
// constraints turn the same bone, the later one waits for the earlier one, so that its result remains, unless this
// would make a cycle. Constraints that must wait for each other in a cycle have no order; they are not applied.
// Constraints whose bones the rig lacks are not applied either. problem() returns the reason. A constraint that is
// switched off delays no other.
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

  // Returns the pose in which the constraints hold, each according to its weight at the frame.
  //   keys  the clip's keys, which include those of the weights
  Pose constrained(const Pose& pose, const Keys& keys, int frame) const;

  // Returns one line that says why a constraint is not applied; empty if it is applied.
  //   index  in the list of constraints
  std::string problem(std::size_t index) const { return problems_[index] ? problems_[index]->what() : ""; }
  // Throws Error with the text of problem(index), if there is one.
  void require_applied(std::size_t index) const;
  // Returns the indices of the applied constraints, in the order in which they are applied.
  const std::vector<std::size_t>& order() const { return order_; }
  // Returns a constraint with the indices of its bones; nothing if the rig does not have these bones.
  const std::optional<ConstraintOnRig>& found(std::size_t index) const { return found_[index]; }
  // Returns the bones that a constraint turns; empty if it is not applied.
  const std::vector<int>& turned(std::size_t index) const { return turned_[index]; }
  const std::shared_ptr<const Constraints>& constraints() const { return constraints_; }
  const std::shared_ptr<const Armature>& armature() const { return armature_; }

 private:
  void find_order();
  // Excludes constraints that wait for each other in a cycle from the order.
  //   circle  each constraint waits for the next one; the last equals the first
  void leave_out(const std::vector<std::size_t>& circle);

  std::shared_ptr<const Constraints> constraints_;
  std::shared_ptr<const Armature> armature_;
  std::vector<std::optional<Error>> problems_;
  std::vector<std::optional<ConstraintOnRig>> found_;
  std::vector<std::vector<int>> turned_;
  std::vector<std::size_t> order_;
};

}  // namespace limber
