// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses kept under a name. By the bones' names, as keys are, so that a change of the rig loses only what it removed,
// and a pose of one limb leaves the others alone.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

struct NamedPose {
  std::string name;                            // unique in its library
  std::map<std::string, glm::dquat> rotation;  // by bone, as in Pose
  std::optional<glm::dvec3> root_translation;  // mm; with a root bone among them
  std::string picture;                         // a PNG of the body in it; may be empty

  bool operator==(const NamedPose&) const = default;
};

using PoseLibrary = std::vector<std::shared_ptr<const NamedPose>>;

// The pose of `bones`, under that name or with a number behind it when the library has one of that name.
NamedPose named_pose(const PoseLibrary& library, const std::string& wanted, const Armature& armature, const Pose& pose,
                     const std::vector<int>& bones);
std::string unique_pose_name(const PoseLibrary& library, const std::string& wanted);

// `pose` with what the named one says of `bones`.
Pose taken_from(const NamedPose& named, const Armature& armature, Pose pose, const std::vector<int>& bones);

}  // namespace limber
