// SPDX-License-Identifier: AGPL-3.0-or-later
// Joints told by the names of bones. Where labels say which bone is the femur and which the tibia
// (core/bones/anatomical_name.h), the knee lies where the two come nearest to each other, whatever the body's build and
// pose; hips and shoulders lie in the middle of the ball at the end of femur and humerus. Marrow and spongy bone count
// with the bone whose name they bear, left and right in one label are parted by the body that was laid over them.
#pragma once

#include <vector>

#include "core/autorig/articulated_fit.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

struct NamedJoint {
  int bone = 0;         // of the mannequin, whose head it is
  glm::dvec3 place{0};  // mm
  double error = 0;     // mm that it may lie off
};

// At most one for each of the mannequin's bones, in their order; none where no label names a bone.
//   mannequin  roughly in place: it tells the sides apart where names do not
std::vector<NamedJoint> named_joints(const LabelVolume& volume, const TissueTable& tissues, const Mannequin& mannequin);

// The mannequin's bones turned and stretched so that they run between such joints.
void lay_along(Mannequin& mannequin, const std::vector<NamedJoint>& joints);

// Whether the joints lie on the sides where the mannequin has them; true where they do not tell.
bool same_sides(const Mannequin& mannequin, const std::vector<NamedJoint>& joints);

}  // namespace limber
