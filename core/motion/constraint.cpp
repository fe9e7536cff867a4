// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/motion/constraint.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <type_traits>

#include "core/motion/constraint_rule.h"
#include "core/motion/key_curve.h"

namespace limber {

namespace {

// Returns the index of the component with the largest absolute value.
int largest(const glm::dvec3& v) {
  const glm::dvec3 size = glm::abs(v);
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

}  // namespace

double weight_at(const Constraint& constraint, const Keys& keys, int frame) {
  const auto track = keys.weights.find(constraint.name);
  if (track == keys.weights.end() || track->second.empty()) return std::clamp(constraint.weight, 0.0, 1.0);
  static const KeyShapes kNone;
  const auto shapes = keys.weight_shapes.find(constraint.name);
  std::map<int, glm::dvec3> around;
  for (const auto& [at, weight] : keys_around(track->second, frame)) around[at] = glm::dvec3(weight, 0, 0);
  return std::clamp(value_at(around, shapes == keys.weight_shapes.end() ? kNone : shapes->second, frame).x, 0.0, 1.0);
}

std::string unique_constraint_name(const Constraints& constraints, const std::string& wanted) {
  const auto taken = [&](const std::string& name) {
    return std::any_of(constraints.list.begin(), constraints.list.end(),
                       [&](const Constraint& constraint) { return constraint.name == name; });
  };
  std::string name = wanted;
  for (int number = 2; taken(name); ++number) name = wanted + " " + std::to_string(number);
  return name;
}

void name_after_bones(std::vector<Constraint>& list, Keys& keys, const std::vector<std::string>& before) {
  const auto is_by_bone = [&](std::size_t i) {
    const std::string wanted = constraint_rule(list[i].kind).name + " " + before[i], &name = list[i].name;
    const bool numbered =
        name.starts_with(wanted + " ") && name.find_first_not_of("0123456789", wanted.size() + 1) == std::string::npos;
    return before[i] != list[i].bone && (name == wanted || numbered);
  };
  // The constraints that are not renamed keep their names, so these names are reserved first.
  Constraints named;
  std::vector<std::size_t> renamed;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (is_by_bone(i)) renamed.push_back(i);
    else named.list.push_back(list[i]);
  }
  std::map<std::string, std::string> now;
  for (const std::size_t i : renamed) {
    const std::string name = unique_constraint_name(named, constraint_rule(list[i].kind).name + " " + list[i].bone);
    now[list[i].name] = name;
    list[i].name = name;
    named.list.push_back(list[i]);
  }
  const auto follow = [&](auto& by_name) {
    std::remove_reference_t<decltype(by_name)> next;
    for (auto& [name, value] : by_name) next[now.contains(name) ? now.at(name) : name] = std::move(value);
    by_name = std::move(next);
  };
  follow(keys.weights);
  follow(keys.weight_shapes);
}

Constraint mirror_image(const Constraint& constraint, const Bone& bone, const Bone& counterpart,
                        const MirrorPlane& plane) {
  Constraint mirrored = constraint;
  mirrored.place = plane.place(constraint.place);
  mirrored.rotation = plane.rotation(constraint.rotation);
  const glm::dmat3 own = rest_axes(bone), other = glm::transpose(rest_axes(counterpart));
  for (int axis = 0; axis < 3; ++axis) {
    // A mirror reverses the sense of a rotation, so the rotation vector is reflected and then negated. The limits of
    // this axis are given to that axis of the counterpart which is most nearly parallel to the result.
    const glm::dvec3 seen = other * -plane.direction(own[axis]);
    const int along = largest(seen);
    mirrored.axes[along] = constraint.axes[axis];
    mirrored.minimum[along] = seen[along] < 0 ? -constraint.maximum[axis] : constraint.minimum[axis];
    mirrored.maximum[along] = seen[along] < 0 ? -constraint.minimum[axis] : constraint.maximum[axis];
  }
  const int aim = static_cast<int>(constraint.aim);
  const glm::dvec3 seen = other * plane.direction((aim % 2 == 0 ? 1.0 : -1.0) * own[aim / 2]);
  const int along = largest(seen);
  mirrored.aim = static_cast<BoneAxis>(2 * along + (seen[along] < 0 ? 1 : 0));
  return mirrored;
}

Constraint with_pose_as_rest(const Constraint& constraint, const Armature& armature, const Pose& pose) {
  Constraint next = constraint;
  const auto posed = posed_from_rest(armature, pose);
  if (const auto bone = armature.find(constraint.bone))
    next.rotation = next.rotation * glm::conjugate(posed[*bone].rotation);
  if (const auto target = armature.find(constraint.target)) {
    next.place = posed[*target] * next.place;
    next.rotation = posed[*target].rotation * next.rotation;
  }
  next.rotation = glm::normalize(next.rotation);
  return next;
}

}  // namespace limber
