// SPDX-License-Identifier: AGPL-3.0-or-later
// The parts that the phantoms are put together from. Each adds its flesh, bones, muscles, tendons, vessels and rig
// bones to an Anatomy, in a local frame that may be mirrored and turned. Sizes are those of an adult of 1.75 m.
#pragma once

#include <string>

#include "core/motion/bvh.h"
#include "core/phantom/anatomy.h"

namespace limber::phantom {

struct LimbPlan {
  Frame root;            // shoulder or hip centre; x to the side (away from the trunk), y to the back, z up the limb
  std::string prefix{};  // of rig bone names: "Left", "Right" or ""
  int flesh_parent = -1;
  int rig_parent = -1;
  double bend_degrees = 0;       // of elbow or knee at rest
  double thinnest_radius = 0.5;  // mm, for vessels, nerves and tendons, so that none is thinner than a voxel
};

// From the humerus to the finger tips. The forearm is half pronated: the palm faces the thigh.
void add_arm(Anatomy& anatomy, const LimbPlan& plan);
// From the femur to the toes. The foot stands flat in `upright`'s axes, however the leg leans.
void add_leg(Anatomy& anatomy, const LimbPlan& plan, const Frame& upright);
// Pelvis, spine, rib cage, organs, shoulder girdle, neck and head; returns where the limbs join.
struct TrunkJoints {
  int flesh, hips_bone;                // places in the Anatomy's flesh and rig
  glm::dvec3 left_hip, left_shoulder;  // centres; the right ones lie across x = 0
};
TrunkJoints add_trunk(Anatomy& anatomy, double thinnest_radius);

// The two samples as they stand: a right arm whose shoulder lies at the origin, and a whole body.
Anatomy arm_anatomy(double thinnest_radius = 0.5);
Anatomy body_anatomy(double thinnest_radius = 0.5);

// A motion of the rig's own hierarchy, in BVH axes (Y up) and mm.
struct Turn {
  std::string bone;
  glm::dvec3 axis;  // world (LPS) at rest
  double degrees;
};
struct MotionFrame {
  std::vector<Turn> turns;
  glm::dvec3 root_offset{0};  // LPS, mm
};
Motion make_motion(const Armature& armature, const std::vector<MotionFrame>& frames, double frame_time);

}  // namespace limber::phantom
