// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/armature.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/base/error.h"

namespace limber {

namespace {
constexpr int kMostBones = 4096;

// A rig in which a coordinate of a position is larger than this, mm (1000 km), is refused.
constexpr double kFarthestMm = 1e9;
// Returns true if the coordinates of a position are within kFarthestMm. Returns false for NaN.
bool near_enough(const glm::dvec3& v) {
  return std::abs(v.x) <= kFarthestMm && std::abs(v.y) <= kFarthestMm && std::abs(v.z) <= kFarthestMm;
}

std::string names_of(const Armature& armature) {
  std::string names;
  for (size_t i = 0; i < armature.bones.size() && i < 8; ++i) names += (i ? ", " : "") + armature.bones[i].name;
  if (armature.bones.size() > 8) names += ", ...";
  return names;
}
}  // namespace

std::optional<int> Armature::find(std::string_view name) const {
  for (size_t i = 0; i < bones.size(); ++i)
    if (bones[i].name == name) return static_cast<int>(i);
  return std::nullopt;
}

int require_bone(const Armature& armature, std::string_view name) {
  if (auto bone = armature.find(name)) return *bone;
  throw Error("no such bone", std::string(name), "use one of the rig's bones (" + names_of(armature) + ")");
}

void check_armature(const Armature& armature, const std::string& where) {
  if (armature.bones.empty()) throw Error("the rig has no bones", where, "add at least one bone with head and tail");
  if (armature.bones.size() > kMostBones)
    throw Error("the rig has " + std::to_string(armature.bones.size()) + " bones", where,
                "use at most " + std::to_string(kMostBones));
  std::set<std::string_view> names;
  for (size_t i = 0; i < armature.bones.size(); ++i) {
    const Bone& bone = armature.bones[i];
    const std::string here = where + ", bone " + std::to_string(i) + (bone.name.empty() ? "" : " (" + bone.name + ")");
    if (bone.name.empty()) throw Error("a bone has no name", here, "give every bone a name of its own");
    if (!names.insert(bone.name).second)
      throw Error("two bones share a name", here, "give every bone a name of its own");
    if (bone.parent < -1 || bone.parent >= static_cast<int>(i))
      throw Error("a bone's parent does not come before it", here, "list parents before their children");
    if (!near_enough(bone.head) || !near_enough(bone.tail) || !std::isfinite(bone.roll))
      throw Error("a bone's position is not a finite number of millimetres within 1000 km", here,
                  "give head, tail and roll as finite numbers");
  }
}

Armature parents_first(std::vector<Bone> bones, const std::string& where) {
  const int count = static_cast<int>(bones.size());
  bool ordered = true;
  for (int i = 0; i < count; ++i) {
    if (bones[i].parent < -1 || bones[i].parent >= count)
      throw Error("the parent of bone " + std::to_string(i) + " is number " + std::to_string(bones[i].parent) +
                      ", but the rig has " + std::to_string(count) + " bones",
                  where, "use the number of one of the rig's bones, or -1 for a root");
    ordered = ordered && bones[i].parent < i;
  }
  if (ordered) return {std::move(bones)};

  // Visits bones depth first from the roots. Bones that are never reached are part of a cycle.
  std::vector<std::vector<int>> children(count);
  std::vector<int> ready, order, place(count);
  for (int i = count; i-- > 0;) (bones[i].parent < 0 ? ready : children[bones[i].parent]).push_back(i);
  while (!ready.empty()) {
    const int bone = ready.back();
    ready.pop_back();
    place[bone] = static_cast<int>(order.size());
    order.push_back(bone);
    ready.insert(ready.end(), children[bone].begin(), children[bone].end());
  }
  if (static_cast<int>(order.size()) != count)
    throw Error("some bones are their own ancestors", where,
                "let every chain of parents end at a bone without a parent");
  Armature armature;
  for (int bone : order) {
    armature.bones.push_back(std::move(bones[bone]));
    int& parent = armature.bones.back().parent;
    if (parent >= 0) parent = place[parent];
  }
  return armature;
}

glm::dmat3 rest_axes(const Bone& bone) {
  const glm::dvec3 along = bone.tail - bone.head;
  const double length = glm::length(along);
  const glm::dvec3 y = length > 0 ? along / length : glm::dvec3(0, 1, 0);

  // Without roll, the bone's axes are the world's axes rotated by the shortest rotation from +y to the bone [Blender,
  // vec_roll_to_mat3]. For a bone along -y this is half a turn about z.
  glm::dmat3 axes(1);
  const double theta = 1 + y.y;
  if (theta > 1e-9) {
    axes[1] = y;
    axes[0] = {1 - y.x * y.x / theta, -y.x, -y.x * y.z / theta};
    axes[2] = {-y.x * y.z / theta, -y.z, 1 - y.z * y.z / theta};
  } else {
    axes = glm::dmat3({-1, 0, 0}, {0, -1, 0}, {0, 0, 1});
  }
  const double c = std::cos(bone.roll), s = std::sin(bone.roll);
  const glm::dvec3 x = axes[0], z = axes[2];
  axes[0] = c * x - s * z;
  axes[2] = s * x + c * z;
  return axes;
}

double roll_of(const Bone& bone, const glm::dvec3& x) {
  Bone straight = bone;
  straight.roll = 0;
  const glm::dmat3 axes = rest_axes(straight);
  return std::atan2(-glm::dot(x, axes[2]), glm::dot(x, axes[0]));
}

glm::dvec3 flex_axis(const Armature& armature, int bone_index) {
  const Bone& bone = armature.bones[bone_index];
  if (bone.limits.type == JointLimits::Type::Hinge) return bone.limits.axis;
  const std::string remedy =
      "give the bone a hinge axis in its limits, or name its joint, as in --joint \"left knee flexion=90\"";
  if (bone.parent < 0) throw Error("the bone has no parent to flex against", bone.name, remedy);

  const Bone& parent = armature.bones[bone.parent];
  const glm::dvec3 a = parent.tail - parent.head, b = bone.tail - bone.head;
  const double lengths = glm::length(a) * glm::length(b);
  const glm::dvec3 axis = glm::cross(a, b);
  // Throws Error if bone and parent are bent by less than 10 degrees, since small errors of their positions would then
  // decide the axis.
  if (lengths == 0 || glm::length(axis) < lengths * std::sin(10 * std::numbers::pi / 180))
    throw Error("the bone is nearly straight with its parent, so its flex axis is not known", bone.name, remedy);
  return glm::normalize(axis);
}

double distance_to_bone(const Bone& bone, const glm::dvec3& p) {
  const glm::dvec3 along = bone.tail - bone.head;
  const double squared_length = glm::dot(along, along);
  const double t = squared_length > 0 ? std::clamp(glm::dot(p - bone.head, along) / squared_length, 0.0, 1.0) : 0.0;
  return glm::length(p - (bone.head + t * along));
}

}  // namespace limber
