// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/constraint_stack.h"

#include <algorithm>
#include <set>

namespace limber {

namespace {

void add_with_parents(std::set<int>& bones, const Armature& armature, int bone) {
  for (; bone >= 0; bone = armature.bones[bone].parent) bones.insert(bone);
}

// Returns the bones whose rotations the constraint's target depends on.
std::set<int> bones_of_target(const ConstraintOnRig& found, const Armature& armature) {
  std::set<int> bones;
  if (found.target < 0) return bones;
  const bool is_relative =
      found.constraint.kind == ConstraintKind::CopyRotation && found.constraint.space == RotationSpace::Parent;
  if (is_relative) bones.insert(found.target);
  else add_with_parents(bones, armature, found.target);
  return bones;
}

// Returns the bones that a constraint reads, beside those that it turns: those of its target, and those above the bones
// that it turns where it holds in the world.
std::set<int> bones_read(const ConstraintOnRig& found, const Armature& armature, const std::vector<int>& turned) {
  std::set<int> bones = bones_of_target(found, armature);
  const bool is_relative =
      found.constraint.kind == ConstraintKind::CopyRotation && found.constraint.space == RotationSpace::Parent;
  if (constraint_rule(found.constraint.kind).target != ConstraintTarget::None && !is_relative)
    for (const int bone : turned) add_with_parents(bones, armature, bone);
  for (const int bone : turned) bones.erase(bone);
  return bones;
}

bool share_a_bone(const std::vector<int>& turned, const std::set<int>& bones) {
  return std::any_of(turned.begin(), turned.end(), [&](int bone) { return bones.contains(bone); });
}

}  // namespace

ConstraintStack::ConstraintStack(std::shared_ptr<const Constraints> constraints,
                                 std::shared_ptr<const Armature> armature)
    : constraints_(std::move(constraints)),
      armature_(std::move(armature)),
      problems_(constraints_->list.size()),
      found_(constraints_->list.size()),
      turned_(constraints_->list.size()) {
  find_order();
}

void ConstraintStack::find_order() {
  const std::vector<Constraint>& list = constraints_->list;
  std::vector<std::set<int>> read(list.size());
  std::set<std::size_t> waiting;
  for (std::size_t i = 0; i < list.size(); ++i) {
    try {
      found_[i].emplace(on_rig(list[i], *armature_));
      const std::vector<int> turned = constraint_rule(list[i].kind).turned(*found_[i], *armature_);
      if (share_a_bone(turned, bones_of_target(*found_[i], *armature_)))
        throw Error("the target moves along with the constrained bone", list[i].name, "choose another target");
      read[i] = bones_read(*found_[i], *armature_, turned);
      turned_[i] = turned;
      waiting.insert(i);
    } catch (const Error& error) {
      problems_[i].emplace(error);
    }
  }
  // Takes the first in the list that waits for no other, again and again [Kahn 1962].
  const auto waits_for = [&](std::size_t one) {
    return std::find_if(waiting.begin(), waiting.end(),
                        [&](std::size_t other) { return other != one && share_a_bone(turned_[other], read[one]); });
  };
  while (!waiting.empty()) {
    const auto next =
        std::find_if(waiting.begin(), waiting.end(), [&](std::size_t one) { return waits_for(one) == waiting.end(); });
    if (next != waiting.end()) {
      order_.push_back(*next);
      waiting.erase(next);
      continue;
    }
    // All wait for another. Whoever goes from each to the one that it waits for comes into a circle.
    std::vector<std::size_t> circle{*waiting.begin()};
    while (true) {
      const std::size_t other = *waits_for(circle.back());
      const auto seen = std::find(circle.begin(), circle.end(), other) - circle.begin();
      circle.push_back(other);
      if (seen == std::ssize(circle) - 1) continue;
      circle.erase(circle.begin(), circle.begin() + seen);
      break;
    }
    leave_out(circle);
    for (const std::size_t one : circle) waiting.erase(one);
  }
}

void ConstraintStack::leave_out(const std::vector<std::size_t>& circle) {
  const auto name = [&](std::size_t place) { return constraints_->list[circle[place % (circle.size() - 1)]].name; };
  for (std::size_t k = 0; k + 1 < circle.size(); ++k) {
    problems_[circle[k]].emplace("these constraints wait for each other in a circle", name(k) + " and " + name(k + 1),
                                 "choose another target, or remove one");
    turned_[circle[k]].clear();
  }
}

Pose ConstraintStack::constrained(const Pose& pose, const Keys& keys, int frame) const {
  Pose next = pose;
  for (const std::size_t index : order_) {
    const Constraint& constraint = constraints_->list[index];
    const double weight = constraint.on ? weight_at(constraint, keys, frame) : 0;
    if (weight == 0) continue;
    PosedRig rig(*armature_, next);
    constraint_rule(constraint.kind).solve(*found_[index], rig);
    for (const int bone : turned_[index]) {
      const glm::dquat& solved = rig.pose().rotation[bone];
      next.rotation[bone] = weight == 1 ? solved : glm::normalize(glm::slerp(next.rotation[bone], solved, weight));
    }
  }
  return next;
}

void ConstraintStack::require_applied(std::size_t index) const {
  if (problems_[index]) throw Error(*problems_[index]);
}

}  // namespace limber
