// SPDX-License-Identifier: AGPL-3.0-or-later
// Corrects which bone is nearest to flesh. Distance alone is not enough: the last bone of a chain should get the flesh
// far beyond its tail, a collarbone should get little flesh, and flesh around a joint belongs to the bone on its side
// of the joint.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

#include "core/rig/armature.h"

namespace limber {

// Corrects the distance to a bone before it is compared with the distances to other bones: the part of the distance
// beyond `reach` is multiplied by `share`. If the body's chest has no ribs (chest_reach.h), the bones of the arms count
// as further away in this comparison, and the distance of the flesh that follows the chest's bones is then shortened as
// if ribs were near it.
struct BoneReach {
  // In a body whose chest has no ribs: whether the bone belongs to the chest or to an arm; None: to neither.
  enum class Cage : std::uint8_t { None, Chest, Arm };
  // Factor on distances inside the missing rib cage, since ribs would be nearer to the flesh than the spine is.
  static constexpr float kInCage = 0.4f;
  // Factor on the distance from which the chest's bones give heat to their flesh inside the missing rib cage.
  static constexpr float kHeldInCage = 0.7f;

  // Distance beyond which `share` applies, mm; infinite: no correction.
  float reach = std::numeric_limits<float>::infinity();
  float share = 1;
  float cage_width = 0;  // half the width of the rib cage, mm
  Cage cage = Cage::None;

  // Returns the corrected distance, for the comparison with other bones' distances.
  //   way  length of the path from the bone, mm
  float operator()(float way) const {
    const float own = way <= reach ? way : reach + share * (way - reach);
    if (cage != Cage::Arm) return own;
    return own <= kInCage * cage_width ? own / kInCage : own + (1 - kInCage) * cage_width;
  }
  // Returns the distance that the strength of the bone's heat depends on, mm, once the bone has won the comparison.
  //   compared  the corrected distance that was compared, mm
  float held_from(float compared) const {
    if (cage == Cage::None) return compared;
    if (cage == Cage::Chest)
      return compared <= cage_width ? kHeldInCage * compared : compared - (1 - kHeldInCage) * cage_width;
    return compared <= cage_width ? kInCage * compared : compared - (1 - kInCage) * cage_width;
  }
};

// Returns the correction for each bone of the armature. The distance to the last bone of a chain is reduced, the
// distance to a bone that only links a limb to the trunk (a collarbone) is increased.
std::vector<BoneReach> reaches_of_bones(const Armature& armature);

// Divides the flesh at joints where exactly two bones meet. Flesh around the joint is about equally near to both bones.
// It belongs to the bone on its side of the plane that bisects the angle between the bones. So the heel belongs to the
// foot and not to the shin.
class Hinges {
 public:
  explicit Hinges(const Armature& armature);

  // Returns the bone to which the flesh at `point` belongs.
  //   nearest, distance  the nearest bone and its distance, mm
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
