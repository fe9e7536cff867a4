// SPDX-License-Identifier: AGPL-3.0-or-later
// Lists the pairs of body parts that seams separate, for the user: for example "left hand" and "left thigh", 1204
// faces.
#pragma once

#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/bones/bone_parts.h"
#include "core/volume/seams.h"
#include "core/volume/tissue_voxels.h"

namespace limber {

struct SeamPair {
  std::string first, second;  // names of body parts; for a bone without a known role, the bone's name
  std::int64_t faces = 0;
  glm::dvec3 middle{0};  // centre of that face of the pair that is nearest to the mean of all its faces, world, mm
};

// Returns the body part of each bone, such as "left hand". A bone whose name is not recognized keeps its own name.
std::vector<std::string> body_parts_of(const Armature& armature);

// Returns the pairs of body parts that seams separate, those with most faces first. Each of a face's two voxels belongs
// to the bone nearest to it through tissue, on a path that crosses no seam.
//   parts  bone parts of the same volume and armature
std::vector<SeamPair> seam_pairs(const Seams& seams, const LabelVolume& volume, const TissueVoxels& tissue,
                                 const Armature& armature, const BoneParts& parts, Progress& progress = no_progress());

}  // namespace limber
