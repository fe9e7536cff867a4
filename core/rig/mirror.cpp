// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/mirror.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <utility>

namespace limber {

namespace {

bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_separator(char c) { return c == '.' || c == '_' || c == '-' || c == ' ' || c == ':'; }

constexpr std::pair<const char*, const char*> kWords[] = {{"Left", "Right"}, {"left", "right"}, {"LEFT", "RIGHT"}};

// Exchanges left and right in a name in which the side is a whole word ("Left", "right"). Returns nothing for any other
// name.
std::optional<std::string> by_word(const std::string& name) {
  for (const auto& [left, right] : kWords)
    for (const auto& [word, other] : {std::pair{left, right}, std::pair{right, left}})
      for (auto at = name.find(word); at != std::string::npos; at = name.find(word, at + 1)) {
        const bool starts = at == 0 || !is_letter(name[at - 1]) || (is_upper(name[at]) && !is_upper(name[at - 1]));
        if (starts) return name.substr(0, at) + other + name.substr(at + std::string(word).size());
      }
  return std::nullopt;
}

char other_letter(char c) {
  switch (c) {
    case 'L': return 'R';
    case 'R': return 'L';
    case 'l': return 'r';
    case 'r': return 'l';
    default: return 0;
  }
}

// Exchanges left and right in a name in which the side is one letter: a letter between separators ("arm.L"), or a
// capital before another capital at the start of the name ("LThumb"). Returns nothing for any other name.
std::optional<std::string> by_letter(const std::string& name) {
  for (std::size_t at = name.size(); at-- > 0;) {
    const char other = other_letter(name[at]);
    if (!other) continue;
    const bool starts = at == 0 || is_separator(name[at - 1]),
               ends = at + 1 == name.size() || is_separator(name[at + 1]);
    const bool capital = at == 0 && is_upper(name[0]) && name.size() > 2 && is_upper(name[1]) && !is_upper(name[2]);
    if ((!starts || !ends || name.size() == 1) && !capital) continue;
    std::string mirrored = name;
    mirrored[at] = other;
    return mirrored;
  }
  return std::nullopt;
}

JointLimits mirrored(const JointLimits& limits, const MirrorPlane& plane) {
  JointLimits other = limits;
  // The axis of a hinge is mirrored as a rotation vector, so that the range of its angle stays the same. The axis of a
  // ball joint is mirrored as a direction, so that the range of its twist changes sign.
  if (limits.type == JointLimits::Type::Hinge) other.axis = -plane.direction(limits.axis);
  if (limits.type == JointLimits::Type::Ball) {
    other.axis = plane.direction(limits.axis);
    other.twist_minimum = -limits.twist_maximum;
    other.twist_maximum = -limits.twist_minimum;
  }
  return other;
}

}  // namespace

std::optional<std::string> mirrored_name(const std::string& name) {
  if (auto other = by_word(name)) return other;
  return by_letter(name);
}

std::vector<int> mirror_pairs(const Armature& armature) {
  std::map<std::string, int> bone_of;
  for (std::size_t b = 0; b < armature.bones.size(); ++b) bone_of[armature.bones[b].name] = static_cast<int>(b);
  std::vector<int> pairs;
  for (std::size_t b = 0; b < armature.bones.size(); ++b) {
    const auto name = mirrored_name(armature.bones[b].name);
    const auto found = name ? bone_of.find(*name) : bone_of.end();
    // Two bones are a pair only if each name is the mirror image of the other.
    const bool agreed = found != bone_of.end() && mirrored_name(found->first) == armature.bones[b].name;
    pairs.push_back(agreed ? found->second : static_cast<int>(b));
  }
  return pairs;
}

// Returns the mirror image of the rotation `q`. For a reflection S and a rotation R about the axis a,
// S R(a, angle) S = R(-S a, angle).
glm::dquat MirrorPlane::rotation(const glm::dquat& q) const {
  const glm::dvec3 v = -direction({q.x, q.y, q.z});
  return {q.w, v.x, v.y, v.z};
}

MirrorPlane mirror_plane(const Armature& armature) {
  const std::vector<int> pairs = mirror_pairs(armature);
  MirrorPlane plane;
  glm::dvec3 across(0), middle(0), all(0), sideless(0);
  int count = 0, without_side = 0;
  for (std::size_t b = 0; b < pairs.size(); ++b) {
    const Bone& bone = armature.bones[b];
    all += (bone.head + bone.tail) / (2.0 * static_cast<double>(pairs.size()));
    if (!mirrored_name(bone.name)) sideless += (bone.head + bone.tail) / 2.0, ++without_side;
    if (pairs[b] <= static_cast<int>(b)) continue;
    // Adds the vector between the two bones of a pair, reversed if it points against the sum so far: the first bone of
    // a pair may be left or right.
    const Bone& other = armature.bones[pairs[b]];
    const glm::dvec3 between = other.head + other.tail - bone.head - bone.tail;
    across += glm::dot(between, across) < 0 ? -between : between;
    middle += (bone.head + bone.tail + other.head + other.tail) / 4.0;
    ++count;
  }
  if (count > 0 && glm::length(across) > 1e-9) plane.normal = glm::normalize(across);
  plane.point = count > 0 ? middle / double(count) : without_side > 0 ? sideless / double(without_side) : all;
  return plane;
}

Pose flipped(const Pose& pose, const Armature& armature) {
  const std::vector<int> pairs = mirror_pairs(armature);
  const MirrorPlane plane = mirror_plane(armature);
  Pose other = rest_pose(armature);
  for (std::size_t b = 0; b < pairs.size(); ++b) other.rotation[b] = plane.rotation(pose.rotation[pairs[b]]);
  other.root_translation = plane.direction(pose.root_translation);
  return other;
}

Bone mirror_image(const Bone& bone, const MirrorPlane& plane) {
  Bone image = bone;
  image.head = plane.place(bone.head);
  image.tail = plane.place(bone.tail);
  image.limits = mirrored(bone.limits, plane);
  image.roll = roll_of(image, -plane.direction(rest_axes(bone)[0]));
  return image;
}

Armature symmetrized(const Armature& armature, const std::vector<int>& bones) {
  const MirrorPlane plane = mirror_plane(armature);
  std::vector<Bone> all = armature.bones;
  const auto place_of = [&](const std::string& name) {
    const auto found = std::find_if(all.begin(), all.end(), [&](const Bone& bone) { return bone.name == name; });
    return found == all.end() ? -1 : static_cast<int>(found - all.begin());
  };
  std::vector<int> sources = bones;
  std::sort(sources.begin(), sources.end());
  for (int b : sources) {
    const auto name = mirrored_name(all[b].name);
    if (!name) continue;
    const int found = place_of(*name);
    Bone image = mirror_image(all[b], plane);
    image.name = *name;
    image.parent = found < 0 ? -1 : all[found].parent;
    if (all[b].parent >= 0) {
      const auto parent = mirrored_name(all[all[b].parent].name);
      const int other = parent ? place_of(*parent) : -1;
      image.parent = other >= 0 ? other : all[b].parent;
    }
    if (found < 0) all.push_back(image);
    else all[found] = image;
  }
  return parents_first(std::move(all), "symmetrized rig");
}

}  // namespace limber
