// SPDX-License-Identifier: AGPL-3.0-or-later
// Where tissue on the two sides of a joint meets when the joint bends. All tissue turns about the joint's axis, so it
// stays on its circle about that axis (exactly with dual quaternions). On every circle of a grid of circles, the runs
// of air between two runs of tissue are gaps: a turn closes a gap by as much as the two sides turn towards each other,
// and what is closed beyond zero overlaps. The resampled body cuts an overlap in its middle, so that each side loses
// half of it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/repair/joint_field.h"

namespace limber {

// The tissues whose volumes are kept, and any other.
enum class FleshClass : std::uint8_t { Skin, Fat, Muscle, Other };
constexpr int kFleshClasses = 3;  // without Other
// Returns the class of each label.
std::vector<FleshClass> flesh_classes(const TissueTable& tissues);

struct JointGap {
  // The two sides: tissue voxels beside the gap, `before` and `after` it in the sense of positive turns.
  FieldPoint before, after;
  float radius = 0, width = 0;            // of the circle, and of the gap along it at rest, mm
  int first_before = 0, first_after = 0;  // in JointGaps::inward
};

struct JointGaps {
  static constexpr int kDepth = 32;  // how many steps into each side the tissues are listed
  double step = 0;                   // distance between circles, and between samples on a circle, mm
  std::vector<JointGap> gaps;
  std::vector<FleshClass> inward;  // for each side of each gap, the tissues at 0 .. kDepth - 1 steps from the gap
};

// Finds the gaps that turns about one axis through the joint can close.
//   axis  unit axis of positive turns
JointGaps joint_gaps(const WeightedBody& body, const JointField& field, const JointMotion& motion,
                     const glm::dvec3& axis);

}  // namespace limber
