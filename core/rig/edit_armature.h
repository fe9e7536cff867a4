// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits a skeleton at rest, as in Blender's edit mode. Each function takes a rig and returns a new one with parents
// before children and unique names. Bones that an edit does not concern stay unchanged. New bones come last. A bone is
// connected to its parent if its head lies on the parent's tail; the ends that meet there are one joint and move
// together.
//
// Edits may reorder or remove bones. bones_of() finds by name where each bone came from, so that poses and weights can
// be carried over.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

struct BoneEnd {
  int bone = 0;
  bool tail = false;

  bool operator==(const BoneEnd&) const = default;
};

const glm::dvec3& place_of(const Armature& armature, const BoneEnd& end);
bool is_connected(const Armature& armature, int bone);
// Returns all bone ends that are one joint with this end, including itself.
std::vector<BoneEnd> joint_of(const Armature& armature, const BoneEnd& end);

// Returns the name, or the name with the first free number ("Arm.001") if it is taken.
std::string free_name(const Armature& armature, const std::string& name);

// Moves each joint of `ends` once, from p to to(p). If a bone's direction changes, its own axes and those of its limits
// are rotated along, by the shortest rotation.
Armature with_moved_ends(const Armature& armature, const std::vector<BoneEnd>& ends,
                         const std::function<glm::dvec3(const glm::dvec3&)>& to);

// Adds a bone. `parent` is the index of its parent; -1: a root.
Armature with_bone(const Armature& armature, const std::string& name, int parent, const glm::dvec3& head,
                   const glm::dvec3& tail);
// Adds a bone from a bone end to a point: a child of that bone if the end is its tail, a sibling if it is its head.
Armature extruded(const Armature& armature, const BoneEnd& from, const glm::dvec3& to);
// Adds a bone between two bone ends: a child of the first end's bone if that end is a tail, else a sibling. If the new
// bone ends at the head of a root of another chain, it becomes the parent of that root. Throws Error if both ends are
// at one position.
Armature filled(const Armature& armature, const BoneEnd& from, const BoneEnd& to);
// Removes bones. The parent of their children becomes the nearest ancestor that stays. Throws Error if no bone would be
// left.
Armature without_bones(const Armature& armature, const std::vector<int>& bones);
// Removes bones as without_bones() does. If a removed bone is connected to its parent, extends the parent to the
// removed bone's tail, so that the chain has no gap.
Armature dissolved(const Armature& armature, const std::vector<int>& bones);
// Splits each bone into `parts` equal pieces, [2, 100]; the first piece keeps the limits.
Armature subdivided(const Armature& armature, const std::vector<int>& bones, int parts = 2);
// Adds copies of the bones at the same positions, after all other bones, in the order of their indices.
Armature duplicated(const Armature& armature, const std::vector<int>& bones);
// Renames a bone; adds a number if the name is taken. Throws Error for an empty name.
Armature renamed(const Armature& armature, int bone, const std::string& name);

// The changes that are applied to each name, in this order.
struct NameChange {
  std::string find, replace;  // replaces every occurrence; none if `find` is empty
  bool other_side = false;    // "Arm.L" becomes "Arm.R"; a name without a side stays
  std::string prefix, suffix;
};
// Applies the changes to the names of bones. Throws Error if a name would be empty or equal that of another bone.
Armature with_names_changed(const Armature& armature, const std::vector<int>& bones, const NameChange& change);

enum class Join { Connected, KeepOffset };
// Sets the parent of bones. With Join::Connected, each bone moves to the parent's tail, with all its descendants.
// Throws Error if a bone would become its own ancestor.
Armature parented(const Armature& armature, const std::vector<int>& bones, int parent, Join join);
Armature unparented(const Armature& armature, const std::vector<int>& bones);
// Removes the parent links between `bones` and all other bones.
Armature separated(const Armature& armature, const std::vector<int>& bones);
// Exchanges head and tail of bones, and reverses the parent-child order of the chains that they form.
Armature with_flipped_direction(const Armature& armature, const std::vector<int>& bones);
// Rotates bones about their own y axes by an angle in radians.
Armature rolled(const Armature& armature, const std::vector<int>& bones, double angle);
// Rolls bones so that their own z axes point as near to a direction as possible. A bone along that direction stays
// unchanged.
Armature with_z_towards(const Armature& armature, const std::vector<int>& bones, const glm::dvec3& direction);
// Moves bones to their mirror image on the other side of the rig. Gives them the names of that side if these are free.
Armature mirrored_bones(const Armature& armature, const std::vector<int>& bones);
// Applies the changes from `before` to `after` also to the bones on the other side of the rig, unless those were
// changed themselves. New bones of one side are also added on the other.
Armature with_mirrored_changes(const Armature& before, const Armature& after);

// Returns, for each bone of `after`, the index of the bone of `before` with the same name; -1: a new bone.
std::vector<int> bones_of(const Armature& before, const Armature& after);
// Returns the pose carried over to an edited rig; new bones are at rest.
//   bones  the result of bones_of()
Pose carried(const Pose& pose, const std::vector<int>& bones);

}  // namespace limber
