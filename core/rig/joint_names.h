// SPDX-License-Identifier: AGPL-3.0-or-later
// What part of a body a joint's name means. Names come from many hands (CMU's "LeftUpLeg", Mixamo's
// "mixamorig:LeftArm", Bandai's "UpperLeg_L", MakeHuman's "upperleg01.R", Unreal's "thigh_l", anatomists' "LeftFemur"),
// so they are cut into words, freed of prefixes and sides, and looked up in one table. Words that mean different parts
// in different schools
// ("shoulder" is a collar bone or an upper arm, "leg" a shank or a thigh, "hip" a thigh or a link to it) are settled by
// which other parts the same side has; the spine is what lies between pelvis and neck, whatever it is called.
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
  // Spine and Neck: 0 is lowest. Fingers: 0 metacarpal, 1 proximal, 2 middle, 3 distal; the thumb's metacarpal is 1.
  int index = 0;

  auto operator<=>(const JointRole&) const = default;
};

// #names roles, no role twice; joints whose names mean nothing known have none.
//   parents  #names, -1 for roots, parents before children
std::vector<std::optional<JointRole>> joint_roles(const std::vector<std::string>& names,
                                                  const std::vector<int>& parents);

// The name in lower case without prefix and separators: equal for names that differ only in how they are written.
std::string plain_name(const std::string& name);

}  // namespace limber
