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

// Returns the bones whose rotations the constraint depends on, without those that it turns: the bones of its target
// and, if it holds in world axes, the ancestors of the bones that it turns.
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

// The constraints that have no position in the order yet. A constraint must wait for each constraint that turns a bone
// that it reads. If two constraints turn the same bone, the later one in the list also waits for the earlier one, so
// that its result remains; this second rule is dropped where it would lead to a cycle.
class WaitingConstraints {
 public:
  WaitingConstraints(std::size_t constraints, std::size_t bones)
      : turned_(constraints),
        read_(constraints),
        turning_(bones) {}

  void add(std::size_t one, const std::vector<int>& turned, const std::set<int>& read) {
    turned_[one] = turned;
    read_[one] = read;
    all_.insert(one);
    for (const int bone : turned) turning_[static_cast<std::size_t>(bone)].insert(one);
  }
  void take(std::size_t one) {
    all_.erase(one);
    for (const int bone : turned_[one]) turning_[static_cast<std::size_t>(bone)].erase(one);
  }
  bool empty() const { return all_.empty(); }

  // Returns the first constraint that waits for no other. Returns nothing if every constraint must wait for another
  // one.
  std::optional<std::size_t> next() const {
    const auto first = [&](const auto& is_ready) -> std::optional<std::size_t> {
      const auto found = std::find_if(all_.begin(), all_.end(), is_ready);
      return found == all_.end() ? std::nullopt : std::optional(*found);
    };
    if (const auto free = first([&](std::size_t one) { return !must_wait_for(one) && !waits_for_earlier(one); }))
      return free;
    // Every constraint waits for another one, so the list's order must be broken. This is allowed only for a constraint
    // in a cycle: one for which all constraints that it waits for also wait. Of these constraints, one that others must
    // wait for comes first.
    const auto is_in_circle = [&](std::size_t one) {
      if (must_wait_for(one)) return false;
      const std::set<std::size_t> earlier = earlier_of(one);
      return std::all_of(earlier.begin(), earlier.end(),
                         [&](std::size_t other) { return is_reached(other, one, false); });
    };
    const auto awaited = first([&](std::size_t one) { return is_awaited(one) && is_in_circle(one); });
    return awaited ? awaited : first(is_in_circle);
  }

  // Returns a cycle of constraints of which each must wait for the next one; the first constraint is repeated at the
  // end. Such a cycle exists whenever next() returns nothing.
  std::vector<std::size_t> circle() const {
    const auto start = std::find_if(all_.begin(), all_.end(), [&](std::size_t one) { return closes_circle(one); });
    std::vector<std::size_t> circle{*start};
    while (true) {
      const std::set<std::size_t> others = must_wait_for_all(circle.back());
      const std::size_t other =
          *std::find_if(others.begin(), others.end(), [&](std::size_t one) { return closes_circle(one); });
      const auto seen = std::find(circle.begin(), circle.end(), other);
      const bool is_closed = seen != circle.end();
      if (is_closed) circle.erase(circle.begin(), seen);
      circle.push_back(other);
      if (is_closed) return circle;
    }
  }

 private:
  const std::set<std::size_t>& turning(int bone) const { return turning_[static_cast<std::size_t>(bone)]; }
  bool must_wait_for(std::size_t one) const {
    return std::any_of(read_[one].begin(), read_[one].end(), [&](int bone) { return !turning(bone).empty(); });
  }
  bool is_awaited(std::size_t one) const {
    return std::any_of(all_.begin(), all_.end(), [&](std::size_t other) {
      return std::any_of(turned_[one].begin(), turned_[one].end(),
                         [&](int bone) { return read_[other].contains(bone); });
    });
  }
  bool waits_for_earlier(std::size_t one) const {
    return std::any_of(turned_[one].begin(), turned_[one].end(),
                       [&](int bone) { return !turning(bone).empty() && *turning(bone).begin() < one; });
  }
  std::set<std::size_t> must_wait_for_all(std::size_t one) const {
    std::set<std::size_t> others;
    for (const int bone : read_[one]) others.insert(turning(bone).begin(), turning(bone).end());
    return others;
  }
  std::set<std::size_t> earlier_of(std::size_t one) const {
    std::set<std::size_t> others;
    for (const int bone : turned_[one]) others.insert(turning(bone).begin(), turning(bone).lower_bound(one));
    return others;
  }
  // Returns whether the first constraint waits for the last one, directly or through other constraints.
  //   must  true: follows only the waits that cannot be dropped
  bool is_reached(std::size_t first, std::size_t last, bool must) const {
    std::set<std::size_t> reached;
    std::vector<std::size_t> open{first};
    while (!open.empty()) {
      const std::size_t now = open.back();
      open.pop_back();
      std::set<std::size_t> others = must_wait_for_all(now);
      if (!must) others.merge(earlier_of(now));
      if (others.contains(last)) return true;
      for (const std::size_t other : others)
        if (reached.insert(other).second) open.push_back(other);
    }
    return false;
  }
  bool closes_circle(std::size_t one) const { return is_reached(one, one, true); }

  std::vector<std::vector<int>> turned_;
  std::vector<std::set<int>> read_;
  std::vector<std::set<std::size_t>> turning_;  // for each bone, the constraints that turn it
  std::set<std::size_t> all_;
};

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
  WaitingConstraints waiting(list.size(), armature_->bones.size());
  const std::vector<PlantedLimb> limbs = planted_limbs(*armature_);
  for (std::size_t i = 0; i < list.size(); ++i) {
    try {
      found_[i].emplace(on_rig(list[i], *armature_, limbs));
      const std::vector<int> turned = constraint_rule(list[i].kind).turned(*found_[i], *armature_);
      if (share_a_bone(turned, bones_of_target(*found_[i], *armature_)))
        throw Error("the constrained bone moves its own target", list[i].name, "choose another target");
      if (!list[i].on) continue;
      turned_[i] = turned;
      waiting.add(i, turned, bones_read(*found_[i], *armature_, turned));
    } catch (const Error& error) {
      problems_[i].emplace(error);
    }
  }
  // Topological sort: repeatedly takes the first constraint of the list that waits for no other [Kahn 1962].
  while (!waiting.empty()) {
    if (const auto next = waiting.next()) {
      order_.push_back(*next);
      waiting.take(*next);
      continue;
    }
    const std::vector<std::size_t> circle = waiting.circle();
    leave_out(circle);
    for (const std::size_t one : circle) waiting.take(one);
  }
}

void ConstraintStack::leave_out(const std::vector<std::size_t>& circle) {
  const auto name = [&](std::size_t place) { return constraints_->list[circle[place % (circle.size() - 1)]].name; };
  for (std::size_t k = 0; k + 1 < circle.size(); ++k) {
    problems_[circle[k]].emplace("these constraints depend on each other in a cycle", name(k) + " and " + name(k + 1),
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
