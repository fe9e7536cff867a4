// SPDX-License-Identifier: AGPL-3.0-or-later
// The joint capsule: shares that rise smoothly from 0 to 1 across the joint, over a width that differs between the
// flexor side, towards which the joint bends, and the extensor side. The joint capsule brush paints the same shape.
#pragma once

#include <vector>

#include "core/repair/joint_field.h"

namespace limber {

struct CapsuleWidths {
  double flexor = 40, extensor = 40;  // lengths over which the share rises from 0 to 1 on each side, mm
};

class CapsuleShape {
 public:
  CapsuleShape(const WeightedBody& body, const JointField& field, const JointMotion& motion);
  // Returns the share of a capsule with these widths at each node of the field.
  std::vector<double> shares(const CapsuleWidths& widths) const;

 private:
  const JointField& field_;
  glm::dvec3 normal_{0}, flexor_{0};  // unit vectors: from the parent to the moving bone, and towards the flexor side
  double thickness_ = 0;              // thickness of the limb from extensor side to flexor side at the joint, mm
};

}  // namespace limber
