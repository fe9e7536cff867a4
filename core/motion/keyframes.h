// SPDX-License-Identifier: AGPL-3.0-or-later
// Poses that bones shall take at frames. By the bones' names, so that a change of the rig loses only what it removed; a
// bone that has no key is not touched.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/rig/pose.h"

namespace limber {

struct Keys {
  std::map<std::string, std::map<int, glm::dquat>> bones;  // rotation by frame; no bone without one
  std::map<int, glm::dvec3> root;                          // of the body: root_translation by frame, mm

  bool operator==(const Keys&) const = default;
  bool empty() const { return bones.empty() && root.empty(); }
};

std::set<int> frames_of(const Keys& keys);

// The pose's rotations of `bones` at that frame, and the body's place with a root bone among them.
void insert_key(Keys& keys, const Armature& armature, const Pose& pose, const std::vector<int>& bones, int frame);
// What these bones have at that frame goes; false when they had nothing.
bool delete_key(Keys& keys, const Armature& armature, const std::vector<int>& bones, int frame);

// All that stands at these frames. A key that arrives where another one stays takes its place.
void delete_keys(Keys& keys, const std::set<int>& frames);
//   frame_of  where what stands at a frame goes; frames that are not in it stay
void move_keys(Keys& keys, const std::map<int, int>& frame_of);
void copy_keys(Keys& keys, const std::map<int, int>& frame_of);

}  // namespace limber
