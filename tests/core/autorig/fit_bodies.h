// SPDX-License-Identifier: AGPL-3.0-or-later
// Bodies whose joints are known, to measure automatic rigging by: real bodies that are deformed smoothly, cropped,
// mirrored, made coarser or stripped of labels, and animals built of capsules.
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

// How another build of the same standing body differs: shares (0.1 is 10 %), and the size as a factor.
struct Build {
  double wider_pelvis = 0, shorter_limbs = 0, larger_head = 0, size = 1;
};

// Where on the standing body a change of build acts, mm: heights of hip, shoulder and neck; distances from the midplane
// at which the arms begin and the trunk is widest; the head's position. The defaults are those of the BodyParts3D man.
struct StandingLandmarks {
  double hip = 820, shoulder = 1322, neck = 1470, arm_from = 165, arm_to = 215, widest = 190;
  glm::dvec3 head{0, -86, 1490};
};

FitBody rebuilt(const FitBody& body, const Build& build, const StandingLandmarks& at = {});

// Returns the body with left and right exchanged, in the volume and in all names.
FitBody mirrored(const FitBody& body);

// Returns the body turned, scaled and shifted in the world. Its voxels do not change.
FitBody moved(const FitBody& body, const glm::dmat3& turn, double scale, const glm::dvec3& shift);

// Returns the voxels whose world positions satisfy `keep`, in the smallest box around them.
FitBody cropped(const FitBody& body, const std::function<bool(const glm::dvec3&)>& keep);

// Returns a coarser body that has only every n-th voxel along each axis.
FitBody sampled(const FitBody& body, const glm::ivec3& every);

// Returns the body with one label for all tissue, and without a label table.
FitBody without_labels(const FitBody& body);

// Returns the body with one label for all bone and another one for all other tissue.
FitBody with_one_bone_label(const FitBody& body);

// Returns the body with one bone label per region, the same for left and right, as reference phantoms have.
FitBody with_regional_labels(const FitBody& body);

// Makes capsules of flesh along the rig, with bones inside that leave gaps at the joints.
//   radii  radius of the flesh around each bone, mm
FitBody animal(const std::string& name, const Armature& rig, const std::vector<double>& radii, double voxel);

}  // namespace limber::test
