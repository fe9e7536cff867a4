// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/pose/pose_library.h"

#include <algorithm>

namespace limber {

std::string unique_pose_name(const PoseLibrary& library, const std::string& wanted) {
  const auto taken = [&](const std::string& name) {
    return std::any_of(library.begin(), library.end(), [&](const auto& pose) { return pose->name == name; });
  };
  std::string name = wanted;
  for (int number = 2; taken(name); ++number) name = wanted + " " + std::to_string(number);
  return name;
}

NamedPose named_pose(const PoseLibrary& library, const std::string& wanted, const Armature& armature, const Pose& pose,
                     const std::vector<int>& bones) {
  NamedPose named{.name = unique_pose_name(library, wanted)};
  for (const int bone : bones) {
    named.rotation[armature.bones[bone].name] = pose.rotation[bone];
    if (armature.bones[bone].parent < 0) named.root_translation = pose.root_translation;
  }
  return named;
}

Pose taken_from(const NamedPose& named, const Armature& armature, Pose pose, const std::vector<int>& bones) {
  for (const int bone : bones) {
    const auto found = named.rotation.find(armature.bones[bone].name);
    if (found == named.rotation.end()) continue;
    pose.rotation[bone] = found->second;
    if (armature.bones[bone].parent < 0 && named.root_translation) pose.root_translation = *named.root_translation;
  }
  return pose;
}

}  // namespace limber
