// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/edit_armature.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <map>

#include "core/base/error.h"
#include "core/rig/mirror.h"

namespace limber {

namespace {

constexpr double kTouching = 1e-4;  // mm; a bone is connected if its head is this near to its parent's tail

std::vector<bool> marked(const Armature& armature, const std::vector<int>& bones) {
  std::vector<bool> marks(armature.bones.size(), false);
  for (const int bone : bones) marks.at(bone) = true;
  return marks;
}

glm::dvec3& end_of(Armature& armature, const BoneEnd& end) {
  return end.tail ? armature.bones[end.bone].tail : armature.bones[end.bone].head;
}

// Returns the shortest rotation from one direction to another; the identity if one of them is zero.
glm::dquat shortest_turn(const glm::dvec3& from, const glm::dvec3& to) {
  const double lengths = glm::length(from) * glm::length(to);
  if (lengths == 0) return {1, 0, 0, 0};
  const double cosine = glm::dot(from, to) / lengths;
  if (cosine < -1 + 1e-12) {
    const glm::dvec3 other = std::abs(from.x) < 0.9 * glm::length(from) ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return glm::angleAxis(std::acos(-1.0), glm::normalize(glm::cross(from, other)));
  }
  const glm::dvec3 axis = glm::cross(from, to) / lengths;
  return glm::normalize(glm::dquat(1 + cosine, axis.x, axis.y, axis.z));
}

// Rotates the bone's own axes, and the axis of its joint limits, by the rotation of its direction.
//   before  the bone before its direction changed
void turn_along(Bone& bone, const Bone& before) {
  const glm::dvec3 from = before.tail - before.head, to = bone.tail - bone.head;
  if (glm::length(glm::cross(from, to)) <= 1e-12 * glm::length(from) * glm::length(to) && glm::dot(from, to) > 0)
    return;
  const glm::dquat turn = shortest_turn(from, to);
  bone.roll = roll_of(bone, turn * rest_axes(before)[0]);
  if (bone.limits.axis != glm::dvec3(0)) bone.limits.axis = glm::normalize(turn * bone.limits.axis);
}

// Returns the index of the bone's nearest ancestor that is not marked. Returns -1 if there is none.
int unmarked_above(const Armature& armature, const std::vector<bool>& marks, int bone) {
  int parent = armature.bones[bone].parent;
  while (parent >= 0 && marks[parent]) parent = armature.bones[parent].parent;
  return parent;
}

// Removes a number at the end of a name: "Arm.002" becomes "Arm".
std::string without_number(const std::string& name) {
  const auto dot = name.rfind('.');
  const bool numbered = dot != std::string::npos && dot > 0 && dot + 1 < name.size() &&
                        std::all_of(name.begin() + static_cast<std::ptrdiff_t>(dot) + 1, name.end(),
                                    [](unsigned char c) { return std::isdigit(c); });
  return numbered ? name.substr(0, dot) : name;
}

Armature dropped(const Armature& armature, const std::vector<bool>& marks) {
  std::vector<int> place(armature.bones.size(), -1);
  Armature rest;
  for (std::size_t b = 0; b < marks.size(); ++b) {
    if (marks[b]) continue;
    place[b] = static_cast<int>(rest.bones.size());
    Bone bone = armature.bones[b];
    const int parent = unmarked_above(armature, marks, static_cast<int>(b));
    bone.parent = parent < 0 ? -1 : place[parent];
    rest.bones.push_back(std::move(bone));
  }
  if (rest.bones.empty()) throw Error("no bone would be left", "rig", "keep at least one bone, or import another rig");
  return rest;
}

}  // namespace

const glm::dvec3& place_of(const Armature& armature, const BoneEnd& end) {
  return end.tail ? armature.bones[end.bone].tail : armature.bones[end.bone].head;
}

bool is_connected(const Armature& armature, int bone) {
  const int parent = armature.bones[bone].parent;
  return parent >= 0 && glm::distance(armature.bones[bone].head, armature.bones[parent].tail) <= kTouching;
}

std::vector<BoneEnd> joint_of(const Armature& armature, const BoneEnd& end) {
  // `above` is the bone whose tail is at the joint to which `end` belongs.
  const int above = end.tail ? end.bone : is_connected(armature, end.bone) ? armature.bones[end.bone].parent : -1;
  if (above < 0) return {end};
  std::vector<BoneEnd> ends = {{above, true}};
  for (int bone = 0; bone < std::ssize(armature.bones); ++bone)
    if (armature.bones[bone].parent == above && is_connected(armature, bone)) ends.push_back({bone, false});
  return ends;
}

std::string free_name(const Armature& armature, const std::string& name) {
  if (!armature.find(name)) return name;
  const std::string base = without_number(name);
  for (int number = 1;; ++number) {
    char text[16];
    std::snprintf(text, sizeof text, ".%03d", number);
    if (!armature.find(base + text)) return base + text;
  }
}

Armature with_moved_ends(const Armature& armature, const std::vector<BoneEnd>& ends,
                         const std::function<glm::dvec3(const glm::dvec3&)>& to) {
  Armature next = armature;
  std::vector<std::array<bool, 2>> moved(armature.bones.size(), {false, false});
  for (const BoneEnd& end : ends) {
    if (moved.at(end.bone)[end.tail]) continue;
    const glm::dvec3 place = to(place_of(armature, end));
    for (const BoneEnd& one : joint_of(armature, end)) {
      end_of(next, one) = place;
      moved[one.bone][one.tail] = true;
    }
  }
  for (std::size_t b = 0; b < moved.size(); ++b)
    if (moved[b][0] || moved[b][1]) turn_along(next.bones[b], armature.bones[b]);
  return next;
}

Armature with_bone(const Armature& armature, const std::string& name, int parent, const glm::dvec3& head,
                   const glm::dvec3& tail) {
  Armature next = armature;
  next.bones.push_back({.name = free_name(armature, name), .parent = parent, .head = head, .tail = tail});
  return next;
}

Armature extruded(const Armature& armature, const BoneEnd& from, const glm::dvec3& to) {
  const Bone& bone = armature.bones.at(from.bone);
  Armature next = with_bone(armature, bone.name, from.tail ? from.bone : bone.parent, place_of(armature, from), to);
  // Sets the roll so that the new bone's x axis is as near as possible to the x axis of the bone that it extends.
  Bone& added = next.bones.back();
  added.roll = roll_of(added, shortest_turn(bone.tail - bone.head, added.tail - added.head) * rest_axes(bone)[0]);
  return next;
}

Armature filled(const Armature& armature, const BoneEnd& from, const BoneEnd& to) {
  const Bone &first = armature.bones.at(from.bone), &last = armature.bones.at(to.bone);
  if (glm::distance(place_of(armature, from), place_of(armature, to)) <= kTouching)
    throw Error("the two joints are at the same position: no bone fits between them", first.name + " and " + last.name,
                "select bones that lie apart");
  Armature next = extruded(armature, from, place_of(armature, to));
  int root = from.bone;
  while (armature.bones[root].parent >= 0) root = armature.bones[root].parent;
  if (!to.tail && last.parent < 0 && root != to.bone)
    next.bones[to.bone].parent = static_cast<int>(next.bones.size()) - 1;
  return parents_first(std::move(next.bones), "filled rig");
}

Armature without_bones(const Armature& armature, const std::vector<int>& bones) {
  return dropped(armature, marked(armature, bones));
}

Armature dissolved(const Armature& armature, const std::vector<int>& bones) {
  const std::vector<bool> marks = marked(armature, bones);
  Armature next = armature;
  // Goes from children to parents, so that if several connected bones are removed, the tail of the last one becomes the
  // tail of the bone that stays.
  for (int bone = static_cast<int>(marks.size()); bone-- > 0;) {
    if (!marks[bone] || !is_connected(armature, bone)) continue;
    const int parent = armature.bones[bone].parent;
    // If further bones meet at the joint between bone and parent, the parent's tail stays there.
    if (joint_of(armature, {bone, false}).size() > 2) continue;
    const Bone before = next.bones[parent];
    next.bones[parent].tail = next.bones[bone].tail;
    turn_along(next.bones[parent], before);
  }
  return dropped(next, marks);
}

Armature subdivided(const Armature& armature, const std::vector<int>& bones, int parts) {
  const std::vector<bool> marks = marked(armature, bones);
  std::vector<Bone> all = armature.bones;
  Armature names = armature;
  for (int bone = 0; bone < std::ssize(marks); ++bone) {
    if (!marks[bone]) continue;
    const Bone whole = armature.bones[bone];
    const auto place_at = [&](int part) { return glm::mix(whole.head, whole.tail, double(part) / parts); };
    all[bone].tail = place_at(1);
    int above = bone;
    for (int part = 1; part < parts; ++part) {
      Bone next{free_name(names, whole.name), above, place_at(part),
                part + 1 == parts ? whole.tail : place_at(part + 1)};
      next.roll = whole.roll;
      names.bones.push_back(next);
      above = static_cast<int>(all.size());
      all.push_back(next);
    }
    for (int child = 0; child < std::ssize(armature.bones); ++child)
      if (armature.bones[child].parent == bone) all[child].parent = above;
  }
  return parents_first(std::move(all), "subdivided rig");
}

Armature duplicated(const Armature& armature, const std::vector<int>& bones) {
  Armature next = armature;
  std::map<int, int> copy_of;
  // Copies parents before their children, whatever the order of `bones`.
  std::vector<int> sorted = bones;
  std::sort(sorted.begin(), sorted.end());
  for (const int bone : sorted) {
    Bone copy = armature.bones.at(bone);
    copy.name = free_name(next, copy.name);
    if (const auto parent = copy_of.find(copy.parent); parent != copy_of.end()) copy.parent = parent->second;
    copy_of[bone] = static_cast<int>(next.bones.size());
    next.bones.push_back(std::move(copy));
  }
  return next;
}

Armature renamed(const Armature& armature, int bone, const std::string& name) {
  if (name.empty()) throw Error("a bone needs a name", armature.bones.at(bone).name, "type a name");
  Armature next = armature;
  next.bones.at(bone).name.clear();
  next.bones[bone].name = free_name(next, name);
  return next;
}

Armature with_names_changed(const Armature& armature, const std::vector<int>& bones, const NameChange& change) {
  Armature next = armature;
  for (const int bone : bones) {
    std::string& name = next.bones.at(bone).name;
    for (std::size_t at = 0; !change.find.empty() && (at = name.find(change.find, at)) != std::string::npos;
         at += change.replace.size())
      name.replace(at, change.find.size(), change.replace);
    if (change.other_side) name = mirrored_name(name).value_or(name);
    name = change.prefix + name + change.suffix;
  }
  std::map<std::string, int> owners;
  for (int bone = 0; bone < std::ssize(next.bones); ++bone) {
    const std::string& name = next.bones[bone].name;
    if (name.empty())
      throw Error("a bone needs a name", armature.bones[bone].name, "keep a part of the name, or add a prefix");
    if (const auto [owner, free] = owners.insert({name, bone}); !free)
      throw Error("two bones would have the name '" + name + "'",
                  armature.bones[owner->second].name + " and " + armature.bones[bone].name,
                  "add a prefix or a suffix that makes the names different");
  }
  return next;
}

Armature parented(const Armature& armature, const std::vector<int>& bones, int parent, Join join) {
  std::vector<Bone> all = armature.bones;
  for (const int bone : bones) {
    if (bone == parent) continue;
    for (int above = parent; above >= 0; above = armature.bones.at(above).parent)
      if (above == bone)
        throw Error("a bone cannot be the child of its own descendant",
                    armature.bones[bone].name + " on " + armature.bones[parent].name,
                    "clear the parent of " + armature.bones[parent].name + " first");
    all.at(bone).parent = parent;
    if (join == Join::KeepOffset) continue;
    const glm::dvec3 by = armature.bones.at(parent).tail - armature.bones[bone].head;
    // Moves the bone with all its descendants.
    std::vector<bool> goes(all.size(), false);
    goes[bone] = true;
    for (int b = 0; b < std::ssize(armature.bones); ++b) {
      const int above = armature.bones[b].parent;
      goes[b] = goes[b] || (above >= 0 && goes[above]);
      if (!goes[b]) continue;
      all[b].head += by;
      all[b].tail += by;
    }
    // Rounding may have left the head beside the parent's tail. Sets it exactly, so that head and tail are one joint.
    all[bone].head = armature.bones[parent].tail;
  }
  return parents_first(std::move(all), "reparented rig");
}

Armature unparented(const Armature& armature, const std::vector<int>& bones) {
  Armature next = armature;
  for (const int bone : bones) next.bones.at(bone).parent = -1;
  return next;
}

Armature separated(const Armature& armature, const std::vector<int>& bones) {
  const std::vector<bool> marks = marked(armature, bones);
  Armature next = armature;
  for (Bone& bone : next.bones)
    if (bone.parent >= 0 && marks[bone.parent] != marks[static_cast<std::size_t>(&bone - next.bones.data())])
      bone.parent = -1;
  return next;
}

Armature with_flipped_direction(const Armature& armature, const std::vector<int>& bones) {
  const std::vector<bool> marks = marked(armature, bones);
  std::vector<Bone> all = armature.bones;
  for (int bone = 0; bone < std::ssize(all); ++bone) {
    if (!marks[bone]) continue;
    const glm::dmat3 axes = rest_axes(armature.bones[bone]);
    std::swap(all[bone].head, all[bone].tail);
    all[bone].roll = roll_of(all[bone], axes[0]);
    all[bone].parent = -1;
  }
  // Reverses the order of parents and children among the flipped bones. If a bone has two flipped children, the first
  // of them becomes its parent.
  for (int bone = std::ssize(all) - 1; bone >= 0; --bone)
    if (const int parent = armature.bones[bone].parent; marks[bone] && parent >= 0 && marks[parent])
      all[parent].parent = bone;
  return parents_first(std::move(all), "flipped rig");
}

Armature rolled(const Armature& armature, const std::vector<int>& bones, double angle) {
  Armature next = armature;
  for (const int bone : bones)
    next.bones.at(bone).roll = std::remainder(next.bones[bone].roll + angle, 2 * std::acos(-1.0));
  return next;
}

Armature with_z_towards(const Armature& armature, const std::vector<int>& bones, const glm::dvec3& direction) {
  Armature next = armature;
  for (const int bone : bones) {
    const glm::dvec3 x = glm::cross(rest_axes(next.bones.at(bone))[1], direction);
    if (glm::length(x) > 1e-9) next.bones[bone].roll = roll_of(next.bones[bone], glm::normalize(x));
  }
  return next;
}

Armature mirrored_bones(const Armature& armature, const std::vector<int>& bones) {
  const MirrorPlane plane = mirror_plane(armature);
  Armature next = armature;
  for (const int bone : bones) {
    const Bone& from = armature.bones.at(bone);
    Bone& to = next.bones[bone];
    to = mirror_image(from, plane);
    to.name = from.name;
  }
  // A mirrored bone gets the name of the other side, unless a bone that is not mirrored has this name.
  for (const int bone : bones)
    if (const auto name = mirrored_name(armature.bones[bone].name)) {
      const auto other = armature.find(*name);
      if (!other || std::find(bones.begin(), bones.end(), *other) != bones.end()) next.bones[bone].name = *name;
    }
  return next;
}

Armature with_mirrored_changes(const Armature& before, const Armature& after) {
  const std::vector<int> pairs = mirror_pairs(after);
  const MirrorPlane plane = mirror_plane(before);
  const std::vector<int> from = bones_of(before, after);
  const auto changed = [&](int bone) {
    if (from[bone] < 0) return false;
    const Bone &a = before.bones[from[bone]], &b = after.bones[bone];
    return a.head != b.head || a.tail != b.tail || a.roll != b.roll || a.limits != b.limits;
  };
  Armature next = after;
  for (int bone = 0; bone < std::ssize(pairs); ++bone) {
    const int other = pairs[bone];
    if (other == bone || !changed(bone) || changed(other)) continue;
    const Bone image = mirror_image(after.bones[bone], plane);
    Bone& to = next.bones[other];
    to.head = image.head;
    to.tail = image.tail;
    to.roll = image.roll;
    to.limits = image.limits;
  }
  std::vector<int> others = pairs;
  for (int bone = 0; bone < std::ssize(pairs); ++bone) {
    const Bone& added = after.bones[bone];
    const auto name = mirrored_name(added.name);
    if (from[bone] >= 0 || others[bone] != bone || !name || next.find(*name)) continue;
    Bone image = mirror_image(added, plane);
    image.name = *name;
    image.parent = added.parent < 0 ? -1 : others[added.parent];
    others[bone] = static_cast<int>(next.bones.size());
    next.bones.push_back(std::move(image));
  }
  return next;
}

std::vector<int> bones_of(const Armature& before, const Armature& after) {
  std::map<std::string, int> place;
  for (int bone = 0; bone < std::ssize(before.bones); ++bone) place[before.bones[bone].name] = bone;
  std::vector<int> from;
  for (const Bone& bone : after.bones) {
    const auto found = place.find(bone.name);
    from.push_back(found == place.end() ? -1 : found->second);
  }
  return from;
}

Pose carried(const Pose& pose, const std::vector<int>& bones) {
  Pose next;
  next.root_translation = pose.root_translation;
  for (const int bone : bones) next.rotation.push_back(bone < 0 ? glm::dquat(1, 0, 0, 0) : pose.rotation.at(bone));
  return next;
}

}  // namespace limber
