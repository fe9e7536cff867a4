// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits a skeleton at rest, with the operations of Blender's edit mode. Each function takes a rig and returns a new
// rig, with parents before children and unique names. Bones that an edit does not concern stay unchanged. New bones
// come last in the list. A bone is connected to its parent if its head is at the parent's tail; all bone ends at this
// position are one joint and move together.
//
// Edits may reorder or remove bones. To carry poses and weights over, bones_of() finds each bone of the new rig in the
// old rig by its name.
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
// Returns all bone ends that belong to the same joint as `end`, including `end` itself.
std::vector<BoneEnd> joint_of(const Armature& armature, const BoneEnd& end);

// Returns the name if no bone has it yet, else the name with the first free number ("Arm.001").
std::string free_name(const Armature& armature, const std::string& name);

// Moves each joint to which one of `ends` belongs, once, from its position p to to(p). If the direction of a bone
// changes, the bone's own axes and the axis of its limits rotate with it, by the shortest rotation.
Armature with_moved_ends(const Armature& armature, const std::vector<BoneEnd>& ends,
                         const std::function<glm::dvec3(const glm::dvec3&)>& to);

// Adds a bone. `parent` is the index of its parent; -1: a root.
Armature with_bone(const Armature& armature, const std::string& name, int parent, const glm::dvec3& head,
                   const glm::dvec3& tail);
// Adds a bone that leads from the end of an existing bone to a point. It becomes a child of the existing bone if it
// starts at that bone's tail, and a sibling if it starts at the head.
Armature extruded(const Armature& armature, const BoneEnd& from, const glm::dvec3& to);
// Adds a bone that leads from the bone end `from` to the bone end `to`. It becomes a child of the bone of `from` if it
// starts at that bone's tail, else a sibling. If `to` is the head of a root of another skeleton, this root becomes its
// child. Throws Error if both ends are at one position.
Armature filled(const Armature& armature, const BoneEnd& from, const BoneEnd& to);
// Removes bones. The nearest ancestor that stays becomes the parent of their children. Throws Error if no bone would be
// left.
Armature without_bones(const Armature& armature, const std::vector<int>& bones);
// Removes bones and closes the gaps in chains: if a removed bone is connected to its parent, the parent is extended to
// the removed bone's tail. The nearest ancestor that stays becomes the parent of the removed bones' children. Throws
// Error if no bone would be left.
Armature dissolved(const Armature& armature, const std::vector<int>& bones);
// Splits each of the bones into a number of equal pieces. The first piece keeps the joint limits.
//   parts  number of pieces, [2, 100]
Armature subdivided(const Armature& armature, const std::vector<int>& bones, int parts = 2);
// Adds copies of the bones, at the same positions. The copies come after all other bones, in the order of the
// originals.
Armature duplicated(const Armature& armature, const std::vector<int>& bones);
// Renames a bone; adds a number if the name is taken. Throws Error for an empty name.
Armature renamed(const Armature& armature, int bone, const std::string& name);

// Changes of a bone's name. They are applied in the order of the members.
struct NameChange {
  std::string find, replace;  // every `find` is replaced by `replace`; empty `find`: no change
  bool other_side = false;    // true: exchanges the sides: "Arm.L" becomes "Arm.R"; a name without a side stays
  std::string prefix, suffix;
};
// Applies the changes to the names of bones. Throws Error if a name would be empty or equal to another bone's name.
Armature with_names_changed(const Armature& armature, const std::vector<int>& bones, const NameChange& change);

enum class Join { Connected, KeepOffset };
// Sets the parent of bones. With Join::Connected, each bone moves to the parent's tail, together with its descendants;
// with Join::KeepOffset, no bone moves. Throws Error if a bone would become its own ancestor.
Armature parented(const Armature& armature, const std::vector<int>& bones, int parent, Join join);
Armature unparented(const Armature& armature, const std::vector<int>& bones);
// Separates `bones` from all other bones: a bone whose parent is in the other group becomes a root.
Armature separated(const Armature& armature, const std::vector<int>& bones);
// Exchanges head and tail of bones, and exchanges parents and children within the chains that these bones form.
Armature with_flipped_direction(const Armature& armature, const std::vector<int>& bones);
// Rotates bones about their own y axes by an angle in radians.
Armature rolled(const Armature& armature, const std::vector<int>& bones, double angle);
// Rolls bones so that their own z axes point as near to a direction as possible. A bone parallel to the direction stays
// unchanged.
Armature with_z_towards(const Armature& armature, const std::vector<int>& bones, const glm::dvec3& direction);
// Moves bones to their mirror images on the other side of the rig. The bones get the names of that side if these names
// are free.
Armature mirrored_bones(const Armature& armature, const std::vector<int>& bones);
// Repeats the changes from `before` to `after`, mirrored, on the bones of the other side of the rig. Bones that were
// changed themselves are left alone. Mirror images of new bones are added too.
Armature with_mirrored_changes(const Armature& before, const Armature& after);

// Returns, for each bone of `after`, the index of the bone with the same name in `before`, or -1 for a new bone.
std::vector<int> bones_of(const Armature& before, const Armature& after);
// Converts a pose of the old rig into a pose of the edited rig, in which new bones are at rest.
//   bones  the result of bones_of()
Pose carried(const Pose& pose, const std::vector<int>& bones);

}  // namespace limber
