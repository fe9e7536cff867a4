// SPDX-License-Identifier: AGPL-3.0-or-later
// A pose of a rig that is changed bone by bone, with the world positions of its joints. All functions but mix_back()
// keep these positions up to date.
#pragma once

#include <vector>

#include "core/rig/pose.h"

namespace limber {

class PosedRig {
 public:
  PosedRig(const Armature& armature, const Pose& pose)
      : armature_(armature),
        pose_(pose),
        posed_(posed_from_rest(armature, pose)) {}

  const Armature& armature() const { return armature_; }
  const Pose& pose() const { return pose_; }
  glm::dvec3 head(int bone) const { return posed_[bone] * armature_.bones[bone].head; }
  glm::dvec3 tail(int bone) const { return posed_[bone] * armature_.bones[bone].tail; }
  glm::dquat turn(int bone) const { return posed_[bone].rotation; }
  const RigidTransform& posed(int bone) const { return posed_[bone]; }

  // Rotates a bone about its head, in world axes, together with its descendants.
  void turn_by(int bone, const glm::dquat& rotation) { turn_to(bone, rotation * posed_[bone].rotation); }
  // Sets the rotation of a bone from its rest pose, in world axes.
  void turn_to(int bone, const glm::dquat& rotation) {
    const int parent = armature_.bones[bone].parent;
    const glm::dquat above = parent < 0 ? glm::dquat(1, 0, 0, 0) : posed_[parent].rotation;
    set(bone, glm::normalize(glm::conjugate(above) * rotation));
  }
  // Sets the rotation of a bone from its rest pose, relative to its parent bone.
  void set(int bone, const glm::dquat& rotation) {
    pose_.rotation[bone] = rotation;
    posed_ = posed_from_rest(armature_, pose_);
  }
  // Sets the rotations of all bones to those of another pose.
  void set_all(const Pose& pose) {
    pose_ = pose;
    posed_ = posed_from_rest(armature_, pose_);
  }
  // Blends a bone's rotation with that of an earlier pose: share 0 gives the earlier rotation, share 1 the current one.
  // The positions of the joints are not updated until another function changes the pose.
  void mix_back(int bone, const Pose& earlier, double share) {
    pose_.rotation[bone] = glm::normalize(glm::slerp(earlier.rotation[bone], pose_.rotation[bone], share));
  }

 private:
  const Armature& armature_;
  Pose pose_;
  std::vector<RigidTransform> posed_;
};

}  // namespace limber
