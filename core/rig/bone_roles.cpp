// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/rig/bone_roles.h"

#include <string>

namespace limber {

BoneRoles bone_roles(const Armature& armature) {
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Bone& bone : armature.bones) {
    names.push_back(bone.name);
    parents.push_back(bone.parent);
  }
  return joint_roles(names, parents);
}

BoneRoles inherited_bone_roles(const Armature& armature) {
  BoneRoles roles = bone_roles(armature);
  for (std::size_t b = 0; b < roles.size(); ++b)
    if (const int parent = armature.bones[b].parent; !roles[b] && parent >= 0) roles[b] = roles[parent];
  return roles;
}

}  // namespace limber
