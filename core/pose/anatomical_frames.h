// SPDX-License-Identifier: AGPL-3.0-or-later
// How far each bone of a rig at rest is from the anatomical position: upright, arms and legs straight, arms hanging,
// palms and feet forward. Bones are known by their names (rig/joint_names.h); their directions tell the rest.
//
// A limb's direction is told by its joints. How it is turned about that direction is told by the joint below it, which
// bends one way: the plane of a bent knee or elbow. A straight one has no plane; then the limb is taken to have been
// swung to where it is from the anatomical position by the shortest way, without a turn about itself, and is turned
// further only as far as the foot's heading or the palm would otherwise be out of what feet and forearms reach.
//
// Joints with a hinge among the rig's limits bend about that hinge and nothing else; all others are straightened
// wholly, so that a limb's direction in a pose is exactly the one that its angles say.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "core/rig/armature.h"
#include "core/rig/joint_names.h"

namespace limber {

// A bone that bends about one axis, as the rig says or because it is a finger's.
struct AnatomicalHinge {
  glm::dvec3 axis{0};  // unit, world at rest: a positive turn flexes (toes: extends; ankles: dorsiflexion)
  double at_rest = 0;  // radians of flexion at rest
};

struct BoneFrame {
  // Turns the bone, in the world, from rest to the anatomical position. A bone without a role turns with its parent.
  glm::dquat anatomical_from_rest{1, 0, 0, 0};
  // Where the joint's axes lie in the anatomical position, from the body's: a foot turned out bends about its own axis.
  glm::dquat joint_axes{1, 0, 0, 0};
  std::optional<AnatomicalHinge> hinge;
};

struct BodyFrames {
  glm::dmat3 body{1};  // columns: the body's left, back and up in the world
  std::map<JointRole, int> bone;
  std::vector<BoneFrame> frames;  // #bones
  bool feet_point_back = false;   // so that left and right may be exchanged
  int only_root = -1;  // the bone that carries all others, where it is one: its joint would turn the whole rig
  // By side, as in BodySide: the angle from palms forward at rest, and the part of it that the forearm's bone takes.
  struct Pronation {
    double at_rest = 0, forearm_share = 0;
  };
  std::map<BodySide, Pronation> pronation;
  // Which side of the body a limb is of; limbs without a side are told by their shape.
  std::map<BodySide, bool> is_right;

  std::optional<int> find(BodyPart part, BodySide side, int index = 0) const;
};

BodyFrames body_frames(const Armature& armature);

// The body's axes from its hips and shoulders, its trunk and its legs. Where they lie within 7.5 degrees of the world's
// axes they are the world's: joints of a body that stands upright are off by as much. Upright (LPS) where the rig does
// not tell.
glm::dmat3 upright_axes(const Armature& armature);

}  // namespace limber
