// SPDX-License-Identifier: AGPL-3.0-or-later
// Bodies whose joints are known, to measure automatic rigging by: real ones carried along smooth maps, cut, mirrored,
// made coarse or robbed of their labels, and animals built of capsules.
#pragma once

#include <functional>
#include <string>

#include "core/rig/armature.h"
#include "core/tissue/tissue_table.h"
#include "core/volume/label_volume.h"

namespace limber::test {

struct FitBody {
  std::string name;
  LabelVolume volume;
  TissueTable tissues;
  Armature truth;
};

// Another build of the same standing body: shares by which it differs.
struct Build {
  double wider_pelvis = 0, shorter_limbs = 0, larger_head = 0, size = 1;
};

// Where the body's landmarks lie that a build changes, mm. The defaults are those of the BodyParts3D man.
struct StandingLandmarks {
  double hip = 820, shoulder = 1322, neck = 1470, arm_from = 165, arm_to = 215, widest = 190;
  glm::dvec3 head{0, -86, 1490};
};

FitBody rebuilt(const FitBody& body, const Build& build, const StandingLandmarks& at = {});

// Left and right exchanged, in the volume and in all names.
FitBody mirrored(const FitBody& body);

// The same voxels, turned, scaled and shifted in the world.
FitBody moved(const FitBody& body, const glm::dmat3& turn, double scale, const glm::dvec3& shift);

// Only what `keep` says of places in the world, in the smallest box.
FitBody cropped(const FitBody& body, const std::function<bool(const glm::dvec3&)>& keep);

// Every so many-th voxel.
FitBody sampled(const FitBody& body, const glm::ivec3& every);

// One label for all tissue, and no table.
FitBody without_labels(const FitBody& body);

// One label for all bone, one for all else.
FitBody with_one_bone_label(const FitBody& body);

// Bones by region, left and right in one label, as reference phantoms have them.
FitBody with_regional_labels(const FitBody& body);

// Capsules of flesh along the rig, with bones inside that leave gaps at the joints.
//   radii  mm, per bone, of the flesh
FitBody animal(const std::string& name, const Armature& rig, const std::vector<double>& radii, double voxel);

}  // namespace limber::test
