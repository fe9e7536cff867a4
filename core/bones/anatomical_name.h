// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds which bone of the body the name of a label means. Recognizes the names of ICRP 110 ("Femora, upper half,
// spongiosa"), TotalSegmentator ("rib_left_7", "vertebrae_L5", "clavicula_right"), BodyParts3D ("Distal phalanx of left
// index finger"), Visible Human and SPL ("femur_bone", "Hip bone (L)").
#pragma once

#include <set>
#include <string_view>

#include "core/rig/joint_names.h"

namespace limber {

// The regions of the body whose bones move together, from the head downwards.
enum class BoneRegion {
  Head,
  Neck,
  Thorax,
  Lumbar,
  Spine,
  Pelvis,
  Shoulder,
  UpperArm,
  Forearm,
  Hand,
  Finger,
  Thigh,
  Shank,
  Foot,
  Toes,
};

struct AnatomicalName {
  // The regions that the name means: several if one label contains several bones ("femur and tibia"), none if the name
  // means no known bone.
  std::set<BoneRegion> regions;
  BodySide side = BodySide::Middle;  // Middle: a bone in the middle of the body, or the name has no side
  // The finger, Thumb to Little, if the name means a finger's bone. Fingers: the name does not say which finger.
  BodyPart finger = BodyPart::Fingers;
  // The segment of a finger, as in JointRole: 0 metacarpal, 1 proximal, 2 middle, 3 distal phalanx. -1: not given.
  int segment = -1;
  bool plural = false;  // true: the label contains several bones ("Ribs", "Wrists and hand bones")
};

AnatomicalName anatomical_name(std::string_view label_name);

// Returns the name of a region in messages and tables, such as "pelvis".
std::string_view to_string(BoneRegion region);

}  // namespace limber
