// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds how far each bone of a rig at rest is from the anatomical position: upright, arms and legs straight, arms
// hanging, palms and feet forward. Bones are recognised by their names (rig/joint_names.h) and measured by their
// directions.
//
// The positions of a limb's joints give its direction. Its rotation about this direction follows from the knee or elbow
// at its lower end, which bends only one way: a bent knee or elbow defines a plane, a straight one does not. In the
// latter case the limb is assumed to have moved from the anatomical position by the shortest rotation. It is rotated
// about its own length only as far as needed to bring foot or palm into the range that feet and forearms reach.
//
// A joint that is a hinge in the rig's limits bends only about this hinge. All other joints are straightened
// completely, so that a limb's direction in a pose is exactly the one that its angles give.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "core/rig/armature.h"
#include "core/rig/joint_names.h"

namespace limber {

// The hinge of a bone that bends about one axis only, either because the rig's limits say so or because it is a finger
// bone.
struct AnatomicalHinge {
  glm::dvec3 axis{0};  // unit vector in the world at rest: a positive turn flexes (toes: extends; ankles: dorsiflexion)
  double at_rest = 0;  // flexion at rest, radians
  // Axis about which the knuckle of a finger and the saddle joint of a thumb also spread. Flexion carries this axis
  // along: rotation from rest = turn(axis, flexion - at_rest) turn(spread_axis, spread - spread_at_rest).
  glm::dvec3 spread_axis{0};  // unit vector in the world at rest, perpendicular to `axis`; zero: the joint only bends
  double spread_at_rest = 0;  // spread at rest, radians
};

struct BoneFrame {
  // The rotation of the bone, in world axes, from the rest pose to the anatomical position. A bone whose name tells no
  // known body part takes the rotation of its parent.
  glm::dquat anatomical_from_rest{1, 0, 0, 0};
  // The rotation from the body's axes to the joint's axes in the anatomical position. The two differ only for a foot
  // that points outwards, since its ankle bends across the foot.
  glm::dquat joint_axes{1, 0, 0, 0};
  std::optional<AnatomicalHinge> hinge;
};

struct BodyFrames {
  glm::dmat3 body{1};  // columns: the body's left, back and up in the world
  std::map<JointRole, int> bone;
  std::vector<BoneFrame> frames;  // one for each bone of the rig
  bool feet_point_back = false;   // true: a foot points backwards, so left and right may be swapped in the bones' names
  int only_root = -1;  // index of the root bone if the rig has only one (its joint turns the whole rig), else -1
  // Pronation at rest, radians (0: palm forward), and the share of the pronation by which the forearm bone rotates. The
  // hand bone rotates by the remaining share.
  struct Pronation {
    double at_rest = 0, forearm_share = 0;
  };
  std::map<BodySide, Pronation> pronation;
  // For each side, true if its limbs are right limbs. For limbs whose names tell no side (Middle), their shape decides.
  std::map<BodySide, bool> is_right;

  std::optional<int> find(BodyPart part, BodySide side, int index = 0) const;
};

BodyFrames body_frames(const Armature& armature);

// Returns the body's axes (left, back, up) in the world, found from its hips, shoulders, trunk and legs. If the axes
// are within 7.5 degrees of world axes, returns these world axes, since the joints of an upright body deviate by up to
// this angle. Returns the LPS axes for a rig without a trunk.
glm::dmat3 upright_axes(const Armature& armature);

}  // namespace limber
