// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds the part of the body to which a joint belongs, from the joint's name. Names follow many conventions (CMU's
// "LeftUpLeg", Mixamo's "mixamorig:LeftArm", Bandai's "UpperLeg_L", MakeHuman's "upperleg01.R", Unreal's "thigh_l",
// anatomists' "LeftFemur"). So they are split into words, stripped of prefixes and sides, and looked up in one table.
// Some words mean different parts in different conventions: "shoulder" is a clavicle or an upper arm, "leg" a shank or
// a thigh, "hip" a thigh or a link to it. The other parts on the same side of the body then decide. The spine is
// everything between pelvis and neck, whatever its name.
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
  // Spine and Neck: counted upwards from 0. Fingers: 0 metacarpal, 1 proximal, 2 middle, 3 distal; the thumb's
  // metacarpal is 1.
  int index = 0;

  auto operator<=>(const JointRole&) const = default;
};

// Returns the role of each joint; nothing if its name is unknown. No two joints have the same role.
//   parents  #names parent indices, -1: root; parents before children
std::vector<std::optional<JointRole>> joint_roles(const std::vector<std::string>& names,
                                                  const std::vector<int>& parents);

// Returns the name in lower case without prefix and separators, with the side first. Names that differ only in their
// spelling are then equal.
std::string plain_name(const std::string& name);

}  // namespace limber
