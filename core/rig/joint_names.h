// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the part of the body to which a joint belongs, from the joint's name. Names follow many conventions (CMU's
// "LeftUpLeg", Mixamo's "mixamorig:LeftArm", Bandai's "UpperLeg_L", MakeHuman's "upperleg01.R", Unreal's "thigh_l",
// anatomists' "LeftFemur"). Names are therefore split into words, stripped of prefixes and sides, and looked up in one
// table. Some words mean different parts in different conventions: "shoulder" is a clavicle or an upper arm, "leg" a
// shank or a thigh, "hip" a thigh or a link from pelvis to thigh. For these words, the names of the other joints on the
// same side of the body decide. All joints between pelvis and neck are the spine, whatever their names are.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace limber {

enum class BodyPart {
  Pelvis,
  Spine,
  Neck,
  Head,
  Clavicle,
  UpperArm,
  Forearm,
  Hand,
  Palm,
  Fingers,
  HipLink,
  Thigh,
  Shank,
  Foot,
  Toes,
  Thumb,
  Index,
  Middle,
  Ring,
  Little,
};

enum class BodySide { Middle, Left, Right };

struct JointRole {
  BodyPart part;
  BodySide side = BodySide::Middle;
  // Number of the bone within its body part. Spine and Neck: counted upwards from 0. Fingers: 0 metacarpal, 1 proximal,
  // 2 middle, 3 distal. Thumb: 1 metacarpal, 2 proximal, 3 distal. Other parts: 0.
  int index = 0;

  auto operator<=>(const JointRole&) const = default;
};

// Returns the role (body part, side and number) of each joint, or nothing for a joint whose name is unknown. No two
// joints have the same role.
//   parents  index of each joint's parent, -1: root; parents come before children
std::vector<std::optional<JointRole>> joint_roles(const std::vector<std::string>& names,
                                                  const std::vector<int>& parents);

// Returns a joint's name in lower case without prefix and separators, with the side first. Different spellings of the
// same name thereby become equal.
std::string plain_name(const std::string& name);

}  // namespace limber
