// SPDX-License-Identifier: AGPL-3.0-or-later
// Keyframes: the rotations that bones take at given frames. They are stored by bone name, so that a change of the rig
// loses only the keys of removed bones. A bone without a key keeps its motion.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

struct Keys {
  // For each bone name, the rotation at each keyed frame. Each listed bone has at least one key.
  std::map<std::string, std::map<int, glm::dquat>> bones;
  std::map<int, glm::dvec3> root;  // for each keyed frame, the body's shift from its rest position, mm

  bool operator==(const Keys&) const = default;
  bool empty() const { return bones.empty() && root.empty(); }
};

std::set<int> frames_of(const Keys& keys);

// Sets keys of `bones` at a frame, with the rotations that the bones have in the pose. If a root bone is among them,
// the body's position is keyed too.
void insert_key(Keys& keys, const Armature& armature, const Pose& pose, const std::vector<int>& bones, int frame);
// Deletes the keys of the bones at a frame. Returns false if there were no such keys.
bool delete_key(Keys& keys, const Armature& armature, const std::vector<int>& bones, int frame);

// Delete, move or copy all keys at the given frames. A key moved onto a frame that has a key replaces it.
void delete_keys(Keys& keys, const std::set<int>& frames);
//   frame_of  for each frame whose keys are moved or copied, the new frame; keys at other frames stay
void move_keys(Keys& keys, const std::map<int, int>& frame_of);
void copy_keys(Keys& keys, const std::map<int, int>& frame_of);

}  // namespace limber
