// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads which bone of the body a label's name means. It knows the names of ICRP 110 ("Femora, upper half, spongiosa"),
// TotalSegmentator ("rib_left_7", "vertebrae_L5", "clavicula_right"), BodyParts3D ("Distal phalanx of left index
// finger"), Visible Human and SPL ("femur_bone", "Hip bone (L)").
#pragma once

#include <set>
#include <string_view>

#include "core/rig/joint_names.h"

namespace limber {

// The bones that move together in a body, from the head downwards.
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
  std::set<BoneRegion>
      regions;  // several where one label holds several bones ("femur and tibia"); none: the name says nothing
  BodySide side = BodySide::Middle;     // Middle: not said
  BodyPart finger = BodyPart::Fingers;  // for Finger: Thumb .. Little, or Fingers where it is not said which
  int segment = -1;     // for Finger: 0 metacarpal, 1 proximal, 2 middle, 3 distal, as in JointRole; -1: not said
  bool plural = false;  // the label holds several bones ("Ribs", "Wrists and hand bones")
};

AnatomicalName anatomical_name(std::string_view label_name);

// "left hip bone" -> "pelvis": the words for messages and tables.
std::string_view to_string(BoneRegion region);

}  // namespace limber
