// SPDX-License-Identifier: AGPL-3.0-or-later
// A library of named poses. A pose stores rotations by bone name. A change of the rig therefore loses only the
// rotations of removed bones, and a pose of one limb leaves the other limbs unchanged.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

struct NamedPose {
  std::string name;                            // name of the pose, unique in the library
  std::map<std::string, glm::dquat> rotation;  // rotation of each bone by its name, as in Pose
  std::optional<glm::dvec3> root_translation;  // shift of the body, mm; empty if the pose has no root bone
  std::string picture;                         // contents of a PNG file, a picture of the posed body; may be empty

  bool operator==(const NamedPose&) const = default;
};

using PoseLibrary = std::vector<std::shared_ptr<const NamedPose>>;

// Makes a library entry from the rotations that `bones` have in a pose. The entry gets the name `wanted`, with a number
// appended if the library has this name already.
NamedPose named_pose(const PoseLibrary& library, const std::string& wanted, const Armature& armature, const Pose& pose,
                     const std::vector<int>& bones);
std::string unique_pose_name(const PoseLibrary& library, const std::string& wanted);

// Returns `pose` with the rotations that the named pose gives to `bones`.
Pose taken_from(const NamedPose& named, const Armature& armature, Pose pose, const std::vector<int>& bones);

}  // namespace limber
