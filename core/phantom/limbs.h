// SPDX-License-Identifier: AGPL-3.0-or-later
// Builds the body parts of the phantoms (procedural sample bodies). Each function adds the flesh, bones, muscles,
// tendons, vessels and rig bones of one part to an Anatomy, in a local frame that may be mirrored and turned. Sizes are
// those of an adult of 1.75 m, in mm.
#pragma once

#include <string>

#include "core/motion/bvh.h"
#include "core/phantom/anatomy.h"

namespace limber::phantom {

struct LimbPlan {
  Frame root;            // origin: shoulder or hip centre; x away from the trunk, y to the back, z up along the limb
  std::string prefix{};  // prefix of the rig bones' names: "Left", "Right" or ""
  int flesh_parent = -1;
  int rig_parent = -1;
  double bend_degrees = 0;       // bend of the elbow or knee at rest
  double thinnest_radius = 0.5;  // vessels, nerves and tendons get at least this radius, mm
};

// Adds an arm from the humerus to the finger tips. The forearm is half pronated: the palm faces the thigh.
void add_arm(Anatomy& anatomy, const LimbPlan& plan);
// Adds a leg from the femur to the toes. The foot stands flat on the ground plane of `upright`, even if the leg leans.
void add_leg(Anatomy& anatomy, const LimbPlan& plan, const Frame& upright);
// The joints at which the limbs are attached to the trunk. add_trunk() adds pelvis, spine, rib cage, organs, shoulder
// girdle, neck and head, and returns these joints.
struct TrunkJoints {
  int flesh, hips_bone;                // indices in the Anatomy's flesh and rig
  glm::dvec3 left_hip, left_shoulder;  // joint centres, mm; the right joints are their mirror images at x = 0
};
TrunkJoints add_trunk(Anatomy& anatomy, double thinnest_radius);

// Return the two phantoms as shapes: a right arm with its shoulder at the origin, and a whole body.
Anatomy arm_anatomy(double thinnest_radius = 0.5);
Anatomy body_anatomy(double thinnest_radius = 0.5);

// The rotation of one bone in one frame of a motion. make_motion() makes a motion from lists of such rotations, with
// the rig's hierarchy, in BVH axes (Y up) and mm.
struct Turn {
  std::string bone;
  glm::dvec3 axis;  // rotation axis in the rest pose, in world axes (LPS)
  double degrees;
};
struct MotionFrame {
  std::vector<Turn> turns;
  glm::dvec3 root_offset{0};  // shift of the root, LPS axes, mm
};
Motion make_motion(const Armature& armature, const std::vector<MotionFrame>& frames, double frame_time);

}  // namespace limber::phantom
