// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds where tissue on the two sides of a joint meets when the joint bends. All tissue turns about the joint's axis,
// so each point stays on its circle about that axis (exactly with dual quaternions). On every circle of a grid of
// circles, each run of air between two runs of tissue is a gap. A turn closes a gap by the angle by which its two sides
// turn towards each other. If a gap becomes negative, the tissue overlaps; the resampled body cuts the overlap in its
// middle, so that each side loses half of it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/repair/joint_field.h"

namespace limber {

// Classes of tissues. The repair preserves the volumes of the first three.
enum class FleshClass : std::uint8_t { Skin, Fat, Muscle, Other };
constexpr int kFleshClasses = 3;  // Skin, Fat and Muscle, whose volumes are preserved
// Returns the class of each label.
std::vector<FleshClass> flesh_classes(const TissueTable& tissues);

struct JointGap {
  // The tissue voxels on both sides of the gap: `before` and `after` it in the direction of positive turns.
  FieldPoint before, after;
  float radius = 0, width = 0;            // radius of the circle, and length of the gap along the circle at rest, mm
  int first_before = 0, first_after = 0;  // indices in JointGaps::inward of the tissues on each side
};

struct JointGaps {
  static constexpr int kDepth = 32;  // number of steps into each side for which tissues are listed
  double step = 0;                   // distance between circles, and between samples on a circle, mm
  std::vector<JointGap> gaps;
  std::vector<FleshClass> inward;  // for each side of each gap, the tissues at 0 .. kDepth - 1 steps from the gap
};

// Finds the gaps that rotations about one axis through the joint can close.
//   axis  unit axis of the rotations; positive angles are counterclockwise about it
JointGaps joint_gaps(const WeightedBody& body, const JointField& field, const JointMotion& motion,
                     const glm::dvec3& axis);

}  // namespace limber
