// SPDX-License-Identifier: AGPL-3.0-or-later
// Edits of a skeleton at rest, as in Blender's edit mode. A rig goes in, a new one comes out: parents before children,
// every name its own, what is not named in the edit left as it was. New bones stand at the end. A bone is connected to
// its parent while its head lies on the parent's tail; the ends that meet there are one joint and move together.
//
// Edits that reorder or drop bones are followed by name (bones_of), so that poses and weights can follow them.
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
// Every end that moves with this one, itself included.
std::vector<BoneEnd> joint_of(const Armature& armature, const BoneEnd& end);

// The name itself, or with the first free number behind it ("Arm.001") where it is taken.
std::string free_name(const Armature& armature, const std::string& name);

// Each joint of `ends` once, to where `to` takes it. A bone that is turned by it takes its own axes and those of its
// limits along, by the shortest turn.
Armature with_moved_ends(const Armature& armature, const std::vector<BoneEnd>& ends,
                         const std::function<glm::dvec3(const glm::dvec3&)>& to);

// At the end; `parent` -1 for none.
Armature with_bone(const Armature& armature, const std::string& name, int parent, const glm::dvec3& head,
                   const glm::dvec3& tail);
// A child from the bone's tail to that point; from its head a sibling.
Armature extruded(const Armature& armature, const BoneEnd& from, const glm::dvec3& to);
// A bone from one end to another: a child of the bone whose tail it leaves, else a sibling; a root whose head it
// reaches hangs on it. Throws Error where the ends meet.
Armature filled(const Armature& armature, const BoneEnd& from, const BoneEnd& to);
// Their children hang on the next bone above that stays. Throws Error when none would be left.
Armature without_bones(const Armature& armature, const std::vector<int>& bones);
// As without_bones; where a bone was connected its parent reaches on to its tail, so that the chain stays whole.
Armature dissolved(const Armature& armature, const std::vector<int>& bones);
// Each in so many equal parts [2, 100]; the limits stay with the first.
Armature subdivided(const Armature& armature, const std::vector<int>& bones, int parts = 2);
// Copies at the same places, at the end, in the order of `bones`.
Armature duplicated(const Armature& armature, const std::vector<int>& bones);
// Throws Error for an empty name.
Armature renamed(const Armature& armature, int bone, const std::string& name);

// What all the names of a list go through, in this order.
struct NameChange {
  std::string find, replace;  // every occurrence; nothing where `find` is empty
  bool other_side = false;    // "Arm.L" becomes "Arm.R"; a name without a side stays
  std::string prefix, suffix;
};
// Throws Error where a name would be empty or belong to two bones.
Armature with_names_changed(const Armature& armature, const std::vector<int>& bones, const NameChange& change);

enum class Join { Connected, KeepOffset };
// Connected, a bone moves to the parent's tail with all that hangs on it. Throws Error where a bone would hang on
// itself.
Armature parented(const Armature& armature, const std::vector<int>& bones, int parent, Join join);
Armature unparented(const Armature& armature, const std::vector<int>& bones);
// Cut loose from all other bones.
Armature separated(const Armature& armature, const std::vector<int>& bones);
// Head and tail change places; a chain runs the other way.
Armature with_flipped_direction(const Armature& armature, const std::vector<int>& bones);
// About their own y axes, radians.
Armature rolled(const Armature& armature, const std::vector<int>& bones, double angle);
// Their own z axes as near to that direction as they come; a bone along it stays.
Armature with_z_towards(const Armature& armature, const std::vector<int>& bones, const glm::dvec3& direction);
// To the other side of the rig, with the names of that side where they are free.
Armature mirrored_bones(const Armature& armature, const std::vector<int>& bones);
// What was changed from `before` to `after` happens to the bones on the other side too, where they were left alone; new
// bones of one side are added on the other.
Armature with_mirrored_changes(const Armature& before, const Armature& after);

// For each bone of `after`, which one it was: the one of the same name; -1 for a new one.
std::vector<int> bones_of(const Armature& before, const Armature& after);
// New bones are at rest.
Pose carried(const Pose& pose, const std::vector<int>& bones);

}  // namespace limber
