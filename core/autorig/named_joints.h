// SPDX-License-Identifier: AGPL-3.0-or-later
// Finds joints by the names of bones. If labels say which bone is the femur and which the tibia
// (core/bones/anatomical_name.h), the knee is where the two come nearest to each other, whatever the body's build and
// pose. Hips and shoulders are at the centre of the ball at the end of femur and humerus. Marrow and spongy bone belong
// to the bone that their label names. If one label contains left and right, the fitted body separates them.
#pragma once

#include <vector>

#include "core/autorig/articulated_fit.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber {

struct NamedJoint {
  int bone = 0;         // index of the mannequin's bone whose head is the joint
  glm::dvec3 place{0};  // position of the joint, world, mm
  double error = 0;     // estimated error, mm
};

// Returns at most one joint for each bone of the mannequin, in the order of the bones. Returns no joints if no label
// names a bone.
//   mannequin  roughly fitted to the volume; separates left from right if the labels' names do not
std::vector<NamedJoint> named_joints(const LabelVolume& volume, const TissueTable& tissues, const Mannequin& mannequin);

// Rotates and stretches the mannequin's bones so that they run from one named joint to the next.
void lay_along(Mannequin& mannequin, const std::vector<NamedJoint>& joints);

// Returns true if the left and right joints are on the same sides as the mannequin's, or if the joints do not show a
// side.
bool same_sides(const Mannequin& mannequin, const std::vector<NamedJoint>& joints);

}  // namespace limber
