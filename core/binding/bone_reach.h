// SPDX-License-Identifier: AGPL-3.0-or-later
// Corrects which bone is nearest to flesh. The shape of a skeleton says more than distance alone: the last bone of a
// chain carries flesh far beyond its tail, a collarbone carries little, and flesh around a joint belongs to the bone on
// its side of the joint.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

#include "core/rig/armature.h"

namespace limber {

// Corrects the distance to a bone before it is compared with other bones' distances: the part of the distance beyond
// `reach` is multiplied by `share`. In a body whose chest has no ribs (chest_reach.h), the bones of the arms count as
// further away in this comparison, and the flesh that the chest wins is held as if ribs were near it.
struct BoneReach {
  // The part that a bone plays where a chest has no ribs.
  enum class Cage : std::uint8_t { None, Chest, Arm };
  // Where a rib cage would be, ribs would be nearer than the spine: distances count this much.
  static constexpr float kInCage = 0.4f;
  // The chest holds its flesh as if it were nearer by this factor.
  static constexpr float kHeldInCage = 0.7f;

  float reach = std::numeric_limits<float>::infinity();  // mm
  float share = 1;
  float cage_width = 0;  // half the width of the rib cage, mm
  Cage cage = Cage::None;

  // Returns the distance that is compared with other bones' distances.
  //   way  length of the path from the bone, mm
  float operator()(float way) const {
    const float own = way <= reach ? way : reach + share * (way - reach);
    if (cage != Cage::Arm) return own;
    return own <= kInCage * cage_width ? own / kInCage : own + (1 - kInCage) * cage_width;
  }
  // Returns the distance that counts for the bone that has won the comparison, from the distance that was compared.
  float held_from(float compared) const {
    if (cage == Cage::None) return compared;
    if (cage == Cage::Chest)
      return compared <= cage_width ? kHeldInCage * compared : compared - (1 - kHeldInCage) * cage_width;
    return compared <= cage_width ? kInCage * compared : compared - (1 - kInCage) * cage_width;
  }
};

// Returns the correction for each bone of the armature. The last bone of a chain counts as nearer than it is, and a
// bone that only links a limb to the trunk (a collarbone) as further away.
std::vector<BoneReach> reaches_of_bones(const Armature& armature);

// Divides the flesh at joints where exactly two bones meet. Flesh around the joint itself is equally near to the two
// bones. It belongs to the bone on its side of the plane that bisects the angle between the bones: the heel belongs to
// the foot, not to the shin.
class Hinges {
 public:
  explicit Hinges(const Armature& armature);

  // Returns the bone that the flesh at `point` belongs to.
  //   nearest, distance  the nearest bone, and its distance, mm
  std::uint16_t bone_at(const glm::vec3& point, std::uint16_t nearest, float distance) const;

 private:
  struct End {
    int other = -1;  // the other bone at this end of the bone; -1: none or several
    glm::vec3 joint, inward, parting;
  };
  static End end_of(const Armature& armature, size_t b, int side);

  std::vector<std::array<End, 2>> ends_;
};

}  // namespace limber
